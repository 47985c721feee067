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
