# sonoloft_embed_kernel(<target> <file.cl> <symbol>)
#   adds to the target a source that defines  extern const char <symbol>[]  in namespace sonoloft: the text of the kernel
#   with the headers of this house that it includes put in their place, so that a device's compiler needs no files.
function(sonoloft_embed_kernel target file symbol)
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${symbol}.cpp")
  file(GLOB texts CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/core/kernels/*")
  add_custom_command(OUTPUT "${output}"
    COMMAND ${CMAKE_COMMAND} "-DROOT=${PROJECT_SOURCE_DIR}" "-DFILE=${file}" "-DSYMBOL=${symbol}" "-DOUTPUT=${output}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed_kernel.cmake"
    DEPENDS ${texts} "${PROJECT_SOURCE_DIR}/cmake/embed_kernel.cmake" VERBATIM)
  target_sources(${target} PRIVATE "${output}")
endfunction()

# sonoloft_embed_file(<target> <file> <namespace> <function>)
#   adds to the target a source that defines  std::string_view <function>()  in the namespace: the bytes of the file, as
#   they are. The assembler takes them in, which a compiler that reads numbers would need seconds for.
function(sonoloft_embed_file target file namespace function)
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  file(CONFIGURE OUTPUT "${output}" @ONLY CONTENT [[
#include <string_view>

asm(".section .rodata\n"
    "@function@_begin: .incbin \"@file@\"\n"
    "@function@_end:\n"
    ".previous\n");
extern "C" const char bytes_begin[] asm("@function@_begin"), bytes_end[] asm("@function@_end");

namespace @namespace@ {
std::string_view @function@();
std::string_view @function@() {
  return {bytes_begin, static_cast<std::size_t>(bytes_end - bytes_begin)};
}
}  // namespace @namespace@
]])
  set_source_files_properties("${output}" PROPERTIES OBJECT_DEPENDS "${file}")
  target_sources(${target} PRIVATE "${output}")
endfunction()
