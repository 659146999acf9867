# What `cmake --install` puts down: headers, CMake package, pkg-config file, licence. Nothing is compiled, so the package
# files go to the architecture-independent data folder; every path in them is relative to the file: the prefix may be moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(softsim_cmake_dir ${CMAKE_INSTALL_DATADIR}/cmake/softsim)
set(softsim_pc_dir ${CMAKE_INSTALL_DATADIR}/pkgconfig)

install(TARGETS softsim EXPORT softsimTargets FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT softsimTargets NAMESPACE softsim:: DESTINATION ${softsim_cmake_dir})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/softsimConfig.cmake.in
                              ${CMAKE_CURRENT_BINARY_DIR}/softsimConfig.cmake
                              INSTALL_DESTINATION ${softsim_cmake_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a new minor version may break its users.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/softsimConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/adapters.cmake ${CMAKE_CURRENT_BINARY_DIR}/softsimConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/softsimConfigVersion.cmake
        DESTINATION ${softsim_cmake_dir})

file(RELATIVE_PATH softsim_pc_includedir ${CMAKE_INSTALL_FULL_DATADIR}/pkgconfig ${CMAKE_INSTALL_FULL_INCLUDEDIR})
configure_file(${CMAKE_CURRENT_LIST_DIR}/softsim.pc.in ${CMAKE_CURRENT_BINARY_DIR}/softsim.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/softsim.pc DESTINATION ${softsim_pc_dir})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
