# Installs the program, the library, its headers and what find_package(halflight) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(halflight_config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/halflight)

install(TARGETS halflight_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS halflight EXPORT halflightTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY src/halflight DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h")
install(EXPORT halflightTargets NAMESPACE halflight:: DESTINATION ${halflight_config_dir})

configure_package_config_file(cmake/halflightConfig.cmake.in halflightConfig.cmake
  INSTALL_DESTINATION ${halflight_config_dir})
write_basic_package_version_file(halflightConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/halflightConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/halflightConfigVersion.cmake
        DESTINATION ${halflight_config_dir})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
