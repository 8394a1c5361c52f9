# An overlay port of libhaptolith, from the checkout or source archive that it is in, for Linux:
#
#     vcpkg install haptolith --overlay-ports=packaging/vcpkg --triplet x64-linux-dynamic
#
# Not tried: vcpkg could not be reached. Its registry may have an Eigen that is newer than the 3.4 that CMake requires. The program
# and libhaptolith_recording are left out.
vcpkg_check_linkage(ONLY_DYNAMIC_LIBRARY)
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
vcpkg_find_acquire_program(PKGCONFIG)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS -DHAPTOLITH_PROGRAM=OFF -DHAPTOLITH_UNITY=ON "-DPKG_CONFIG_EXECUTABLE=${PKGCONFIG}")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/haptolith)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/lib/python3"
  "${CURRENT_PACKAGES_DIR}/lib/python3")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
