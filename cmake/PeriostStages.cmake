# periost_add_stage(NAME SOURCES a.cpp ... [LIBRARIES lib ...] [VERSION 1.2] [LICENCE BSD-3-Clause])
#
# Builds the stage NAME from its sources (the algorithm and the thin stage.cpp, which ends in PERIOST_STAGE).
# In Periost's own tree the stage is linked into the program and listed; elsewhere, against an installed Periost, the
# same call makes a plugin, NAME.so, that `plugins:` or PERIOST_PLUGIN_PATH loads. VERSION and LICENCE are the
# plugin's own.
set(PERIOST_PLUGIN_ENTRY ${CMAKE_CURRENT_LIST_DIR}/plugin_entry.cpp.in)

function(periost_add_stage name)
  cmake_parse_arguments(ARG "" "VERSION;LICENCE" "SOURCES;LIBRARIES" ${ARGN})
  if(TARGET periost_framework)
    add_library(periost_stage_${name} STATIC ${ARG_SOURCES})
    target_link_libraries(periost_stage_${name} PUBLIC periost_framework PRIVATE periost_warnings ${ARG_LIBRARIES})
    periost_quick_build(periost_stage_${name} periost_framework TOGETHER)
    set_property(GLOBAL APPEND PROPERTY PERIOST_STAGES ${name})
    return()
  endif()
  configure_file(${PERIOST_PLUGIN_ENTRY} ${CMAKE_CURRENT_BINARY_DIR}/${name}_entry.cpp @ONLY)
  add_library(${name} MODULE ${ARG_SOURCES} ${CMAKE_CURRENT_BINARY_DIR}/${name}_entry.cpp)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX .so CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden
                                           VISIBILITY_INLINES_HIDDEN ON)
  target_compile_definitions(${name} PRIVATE PERIOST_VERSION="${Periost_VERSION}")
  # As Periost itself: results must not depend on what the compiler chose to fuse.
  target_compile_options(${name} PRIVATE -ffp-contract=off)
  target_link_libraries(${name} PRIVATE Periost::framework ${ARG_LIBRARIES})
endfunction()
