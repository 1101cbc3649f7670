# cmake --install: programs in bin, libperiost, headers under include/periost, and the CMake package `Periost` from
# which plugins are built (examples/plugin_stage).
include(CMakePackageConfigHelpers)
set(PERIOST_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/Periost)

set_target_properties(periost_framework PROPERTIES EXPORT_NAME framework)
install(TARGETS periost_framework EXPORT PeriostTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(program periost periost-tetgen)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()
foreach(part base data geometry param stage)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/pipeline/${part} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/periost/pipeline
          FILES_MATCHING PATTERN "*.h")
endforeach()

install(EXPORT PeriostTargets NAMESPACE Periost:: DESTINATION ${PERIOST_PACKAGE_DIR})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/PeriostConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/package/PeriostConfig.cmake
                              INSTALL_DESTINATION ${PERIOST_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/PeriostConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/PeriostConfig.cmake ${PROJECT_BINARY_DIR}/package/PeriostConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/PeriostStages.cmake ${CMAKE_CURRENT_LIST_DIR}/plugin_entry.cpp.in
        DESTINATION ${PERIOST_PACKAGE_DIR})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
