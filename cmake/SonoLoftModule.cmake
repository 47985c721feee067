# How every room of the house is declared: the same language, warnings and header checks for all.
include(CTest)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # What ccache asks for where headers are precompiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "${CCACHE_PROGRAM}")
  set(CMAKE_C_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

set(SONOLOFT_SANITIZE "" CACHE STRING "Sanitizers for every target, e.g. address,undefined or thread")

add_library(sonoloft_flags INTERFACE)
target_compile_options(sonoloft_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror
  # The same expression must round the same wherever the compiler puts it (chunk borders, batch and online runs).
  -ffp-contract=off
  -fno-math-errno)  # so that square roots go four at a time
if(SONOLOFT_SANITIZE)
  target_compile_options(sonoloft_flags INTERFACE -fsanitize=${SONOLOFT_SANITIZE} -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)  # g++ 12 warns of what instrumentation adds
  target_link_options(sonoloft_flags INTERFACE -fsanitize=${SONOLOFT_SANITIZE})
endif()

# sonoloft_module(<name> SOURCES ... HEADERS ... [PUBLIC libs...] [PRIVATE libs...] [INCLUDES_FROM folder]
#                 [PRECOMPILED common|exact|none])
#   declares the static library sonoloft_<name>, alias sonoloft::<name>; HEADERS are public and must compile alone.
#   Includes are written from the root of the house, "core/cells/cell_complex.h", or from the folder that is given.
#   PRECOMPILED is the set of SonoLoftPrecompiled.cmake that its sources are given; without it, `common`.
function(sonoloft_module name)
  cmake_parse_arguments(ARG "" "INCLUDES_FROM;PRECOMPILED" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  if(NOT ARG_INCLUDES_FROM)
    set(ARG_INCLUDES_FROM "${PROJECT_SOURCE_DIR}")
  endif()
  add_library(sonoloft_${name} STATIC ${ARG_SOURCES})
  add_library(sonoloft::${name} ALIAS sonoloft_${name})
  target_sources(sonoloft_${name} PUBLIC FILE_SET HEADERS BASE_DIRS "${ARG_INCLUDES_FROM}" FILES ${ARG_HEADERS})
  target_include_directories(sonoloft_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
                                                     "$<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>")
  target_link_libraries(sonoloft_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:sonoloft_flags>)
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED common)
  endif()
  if(TARGET sonoloft_precompiled_${ARG_PRECOMPILED})
    target_precompile_headers(sonoloft_${name} REUSE_FROM sonoloft_precompiled_${ARG_PRECOMPILED})
  endif()
endfunction()

# sonoloft_test(<name> LABEL unit|parity|property|integration SOURCES ... LIBS ...)
#   one doctest program, one ctest entry; the working folder is the source tree.
function(sonoloft_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(target test_${ARG_LABEL}_${name})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LIBS} sonoloft_test_main $<BUILD_INTERFACE:sonoloft_flags>)
  target_precompile_headers(${target} REUSE_FROM sonoloft_precompiled_test)
  add_test(NAME ${ARG_LABEL}.${name} COMMAND ${target} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
  set_tests_properties(${ARG_LABEL}.${name} PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
  if(SONOLOFT_SANITIZE)
    set_tests_properties(${ARG_LABEL}.${name} PROPERTIES TIMEOUT 900  # instrumented code is slow
      ENVIRONMENT "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/tsan.supp")
  endif()
endfunction()
