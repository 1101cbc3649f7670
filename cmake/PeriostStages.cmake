# periost_add_stage(NAME SOURCES a.cpp ... LIBRARIES lib ...)
#
# Builds the stage NAME from its sources (the algorithm and the thin stage.cpp, which ends in PERIOST_STAGE).
# In Periost's own tree the stage is linked into the program and listed; elsewhere, against an installed Periost, the
# same call makes a plugin, NAME.so, that `plugins:` or PERIOST_PLUGIN_PATH loads.
function(periost_add_stage name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_library(periost_stage_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(periost_stage_${name} PUBLIC periost_framework PRIVATE periost_warnings ${ARG_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY PERIOST_STAGES ${name})
endfunction()
