# Installed packages: grainlaw::dem, grainlaw::continuum, grainlaw::calibration.
include(CMakePackageConfigHelpers)

set(installed continuum)
set(headers continuum)
if(TARGET grainlaw_dem_data)
  list(APPEND installed dem_data)
  list(APPEND headers dem)
endif()
if(TARGET grainlaw_dem)
  list(APPEND installed dem)
endif()
if(TARGET grainlaw_calibration)
  list(APPEND installed calibration)
  list(APPEND headers calibration)
endif()

list(TRANSFORM installed PREPEND grainlaw_ OUTPUT_VARIABLE targets)
install(TARGETS ${targets} EXPORT grainlawTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder IN LISTS headers)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/grainlaw
    FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT grainlawTargets NAMESPACE grainlaw::
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainlaw)
configure_package_config_file(cmake/grainlawConfig.cmake.in grainlawConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainlaw)
write_basic_package_version_file(grainlawConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/grainlawConfig.cmake
              ${PROJECT_BINARY_DIR}/grainlawConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/grainlaw)
install(DIRECTORY data/tables data/scenes data/cases data/campaigns
  DESTINATION ${CMAKE_INSTALL_DATADIR}/grainlaw)
