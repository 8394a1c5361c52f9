# Every dependency is a Debian 12 package; ./dev installs them (see the list there).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
find_package(Boost 1.74 REQUIRED)  # headers only: Math, Lockfree
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(sodium REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(nlopt REQUIRED IMPORTED_TARGET nlopt)
pkg_check_modules(sdl2 REQUIRED sdl2)  # its headers: the library is loaded when somebody wants it (device/drivers/sdl.h)
find_path(SPNAV_INCLUDE_DIR spnav.h REQUIRED)  # likewise
if(HAPTOLITH_PROGRAM)
  find_package(CLI11 REQUIRED)
  find_package(spdlog REQUIRED)
  pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5)
  find_package(SQLiteCpp 3.2 REQUIRED)
  # ROS 2's network without ROS 2: a program without it says what to install (src/haptolith/ros2).
  find_package(CycloneDDS 0.10 QUIET)
  if(CycloneDDS_FOUND)
    enable_language(C)  # of what idlc makes
  endif()
endif()
