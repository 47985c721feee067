# What `cmake --install` puts where, and how other projects find it: find_package(SonoLoft COMPONENTS ...), pkg-config.
# Both are installed, and who links it chooses:
#   static  every room is a library
#   shared  two libraries, sonoloft_cpp of all rooms and sonoloft of the C interface, each complete in itself; a linker
#           script says what they export, since the rooms are compiled once for all
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(c_includes "${CMAKE_INSTALL_INCLUDEDIR}")
set(cpp_includes "${CMAKE_INSTALL_INCLUDEDIR}/sonoloft")
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/SonoLoft")
set(from_here "${CMAKE_CURRENT_LIST_DIR}")

# The components and their rooms.
set(rooms_protocol protocol)
set(rooms_core slice background cells slopes completion field gpu octree mesh display coverage reconstructor io voxels tracking segmentation)
set(rooms_scan device usb scan record)
set(rooms_probe firmware port probe simulator simulated)
set(rooms_cpp ${rooms_protocol} ${rooms_core} ${rooms_scan} ${rooms_probe})
set(rooms_capi capi)
set(rooms_igtl igtl)
set(rooms_offline offline)

add_custom_target(sdk COMMENT "All that is installed as component sdk")

# install_libraries(<export> <include folder> <targets>...)
function(install_libraries export includes)
  add_dependencies(sdk ${ARGN})
  install(TARGETS ${ARGN} EXPORT SonoLoft-${export} COMPONENT sdk
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    FILE_SET HEADERS DESTINATION "${includes}" INCLUDES DESTINATION "${includes}")
  install(EXPORT SonoLoft-${export} NAMESPACE sonoloft:: DESTINATION "${package_dir}" COMPONENT sdk)
endfunction()

# install_rooms(<component> <include folder>): static
function(install_rooms component includes)
  foreach(room ${rooms_${component}})
    set_target_properties(sonoloft_${room} PROPERTIES EXPORT_NAME ${room})
  endforeach()
  list(TRANSFORM rooms_${component} PREPEND sonoloft_ OUTPUT_VARIABLE targets)
  install_libraries(${component} "${includes}" ${targets})
endfunction()

# install_shared(<name> <output name> <soversion> <include folder> <rooms>...): one library of whole rooms, which exports
# what <name>.exports says
function(install_shared name output soversion includes)
  set(script "${from_here}/${name}.exports")
  list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_OBJECTS:sonoloft_\\1>" OUTPUT_VARIABLE objects)
  add_library(${name} SHARED ${objects})
  set_target_properties(${name} PROPERTIES OUTPUT_NAME ${output} VERSION ${PROJECT_VERSION} SOVERSION ${soversion}
    LINKER_LANGUAGE CXX LINK_DEPENDS "${script}" VERIFY_INTERFACE_HEADER_SETS OFF)
  target_link_options(${name} PRIVATE "LINKER:--version-script=${script}")
  if(NOT SONOLOFT_SANITIZE)  # whose symbols the program has
    target_link_options(${name} PRIVATE LINKER:--no-undefined)
  endif()
  foreach(room ${ARGN})
    target_link_libraries(${name} PRIVATE sonoloft_${room})
    get_target_property(headers sonoloft_${room} HEADER_SET)
    get_target_property(base sonoloft_${room} HEADER_DIRS)
    target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${base} FILES ${headers})
  endforeach()
  install_libraries(${name} "${includes}" ${name})
endfunction()

# link_order(<out> <rooms>...): these and all below them, each before those that it needs
function(link_order out)
  set(order)
  foreach(room ${ARGN})
    list(APPEND order ${room})
    get_target_property(links sonoloft_${room} LINK_LIBRARIES)
    list(FILTER links INCLUDE REGEX "^sonoloft::")
    list(TRANSFORM links REPLACE "^sonoloft::" "")
    if(links)
      link_order(below ${links})
      list(APPEND order ${below})
    endif()
  endforeach()
  list(REVERSE order)
  list(REMOVE_DUPLICATES order)
  list(REVERSE order)
  set(${out} ${order} PARENT_SCOPE)
endfunction()

# static_libs(<out> <rooms>...): how a linker is told
function(static_libs out)
  link_order(order ${ARGN})
  list(TRANSFORM order PREPEND "-lsonoloft_")
  list(JOIN order " " libs)
  set(${out} "${libs} -pthread -lstdc++ -lm" PARENT_SCOPE)
endfunction()

# install_pkg_config(<name> <what it is> <include folder> <requires> <libs>)
function(install_pkg_config name what includes requires libs)
  file(RELATIVE_PATH to_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  configure_file("${from_here}/pkg-config.in" "${name}.pc" @ONLY)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT sdk)
endfunction()

foreach(component protocol core scan probe)
  install_rooms(${component} "${cpp_includes}")
endforeach()
install_rooms(capi "${c_includes}")
set(installed protocol core scan probe capi)
if(TARGET sonoloft_offline)
  install_rooms(offline "${cpp_includes}")
  list(APPEND installed offline)
else()
  message(STATUS "SonoLoft is installed without its component offline: no CGAL Mesh_3, or SONOLOFT_OFFLINE is off")
endif()

if(TARGET sonoloft_igtl)
  install_rooms(igtl "${cpp_includes}")
  list(APPEND installed igtl)
  install_pkg_config(sonoloft-igtl "${PROJECT_DESCRIPTION}: OpenIGTLink server, C++" "${cpp_includes}" "sonoloft-cpp"
    "-lsonoloft_igtl -lOpenIGTLink")
else()
  message(STATUS "SonoLoft is installed without its component igtl: no OpenIGTLink (Debian: libopenigtlink-dev)")
endif()

install_shared(sonoloft_cpp sonoloft_cpp ${PROJECT_VERSION} "${cpp_includes}" ${rooms_cpp})
install_shared(sonoloft_c sonoloft ${PROJECT_VERSION_MAJOR} "${c_includes}" capi)
target_link_libraries(sonoloft_cpp PUBLIC Eigen3::Eigen tl::expected)
# The C interface asks nothing of who links it.
set_target_properties(sonoloft_c PROPERTIES EXPORT_NAME capi)
set_target_properties(sonoloft_cpp PROPERTIES EXPORT_NAME cpp)

set(outside "OpenCL zlib pugixml libusb-1.0 gmp")
static_libs(c_libs capi)
static_libs(cpp_libs ${rooms_cpp})
install_pkg_config(sonoloft "${PROJECT_DESCRIPTION}: C" "${c_includes}" "" "-lsonoloft")
install_pkg_config(sonoloft-static "${PROJECT_DESCRIPTION}: C, static" "${c_includes}" "${outside}" "${c_libs}")
install_pkg_config(sonoloft-cpp "${PROJECT_DESCRIPTION}: C++" "${cpp_includes}" "eigen3" "-lsonoloft_cpp")
install_pkg_config(sonoloft-cpp-static "${PROJECT_DESCRIPTION}: C++, static" "${cpp_includes}" "eigen3 ${outside}"
  "${cpp_libs} -lmeshoptimizer")

configure_package_config_file("${from_here}/SonoLoftConfig.cmake.in" SonoLoftConfig.cmake
  INSTALL_DESTINATION "${package_dir}")
write_basic_package_version_file(SonoLoftConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/SonoLoftConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/SonoLoftConfigVersion.cmake"
  DESTINATION "${package_dir}" COMPONENT sdk)

# Headers that are made by the build.
install(FILES "${PROJECT_BINARY_DIR}/generated/sonoloft/version.h" DESTINATION "${cpp_includes}/sonoloft" COMPONENT sdk)
install(FILES "${PROJECT_BINARY_DIR}/generated/protocol/usb_ids.h" DESTINATION "${cpp_includes}/protocol" COMPONENT sdk)
