# install and find_package(umbra): umbra::core, umbra::shadows, and the program.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS umbra_core umbra_shadows EXPORT umbraTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS umbra_images LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS umbra RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(folder core shadows)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/umbra
    FILES_MATCHING PATTERN "*.h" PATTERN "*.def")
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/umbra/scenes PATTERN "real" EXCLUDE)
set_target_properties(umbra_core PROPERTIES EXPORT_NAME core)
set_target_properties(umbra_shadows PROPERTIES EXPORT_NAME shadows)
install(EXPORT umbraTargets NAMESPACE umbra:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/umbra)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/umbraConfig.cmake.in ${PROJECT_BINARY_DIR}/umbraConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/umbra)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/umbraConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/umbraConfig.cmake ${PROJECT_BINARY_DIR}/umbraConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/umbra)
