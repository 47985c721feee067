# For projects of their own within the house: writes sonoloft/version.h with the version that the house states.
file(STRINGS "${PROJECT_SOURCE_DIR}/CMakeLists.txt" stated REGEX "^project\\(SonoLoft VERSION ")
string(REGEX REPLACE ".*VERSION ([0-9.]+).*" "\\1" PROJECT_VERSION "${stated}")
string(REPLACE "." ";" numbers "${PROJECT_VERSION}")
list(POP_FRONT numbers PROJECT_VERSION_MAJOR PROJECT_VERSION_MINOR PROJECT_VERSION_PATCH)
configure_file("${PROJECT_SOURCE_DIR}/cmake/version.h.in" "${PROJECT_BINARY_DIR}/generated/sonoloft/version.h" @ONLY)
