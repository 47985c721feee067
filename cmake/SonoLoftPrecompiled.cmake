# Headers of others that take seconds to read, compiled once a set instead of once a file: most of the time that a fresh
# checkout took. Sources include what they use all the same; tests/fuzz, headers that must compile alone and the packages
# that link the installed libraries do without.

# sonoloft_precompiled(<set> HEADERS ... [LIBS ...])
function(sonoloft_precompiled set)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS" ${ARGN})
  set(source "${PROJECT_BINARY_DIR}/generated/precompiled/${set}.cpp")
  file(CONFIGURE OUTPUT "${source}" CONTENT "// Nothing: the headers are what is compiled.\n")
  add_library(sonoloft_precompiled_${set} OBJECT EXCLUDE_FROM_ALL "${source}")
  target_link_libraries(sonoloft_precompiled_${set} PRIVATE ${ARG_LIBS} sonoloft_flags)
  target_precompile_headers(sonoloft_precompiled_${set} PRIVATE ${ARG_HEADERS})
endfunction()

set(SONOLOFT_COMMON_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
    <mutex> <optional> <span> <string> <thread> <unordered_map> <vector> <Eigen/Geometry> <tl/expected.hpp>)
sonoloft_precompiled(common HEADERS ${SONOLOFT_COMMON_HEADERS} LIBS Eigen3::Eigen tl::expected)
sonoloft_precompiled(exact HEADERS ${SONOLOFT_COMMON_HEADERS} <CGAL/Exact_predicates_exact_constructions_kernel.h>
                     LIBS CGAL::CGAL Eigen3::Eigen tl::expected)
