# Every third party in one place, all from Debian 12. The licence of each is in docs/decisions/licences.md.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(tl-expected REQUIRED)
find_package(ZLIB REQUIRED)
find_package(pugixml REQUIRED)
find_package(CGAL 5.5 REQUIRED)
find_package(OpenCL REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(embree 3 REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(USBREDIRPARSER IMPORTED_TARGET libusbredirparser-0.5)
find_package(OpenIGTLink QUIET NO_MODULE)

# Eigen's headers are not held to our warnings.
get_target_property(_eigen_includes Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${_eigen_includes}")

find_program(FLATC flatc REQUIRED)
