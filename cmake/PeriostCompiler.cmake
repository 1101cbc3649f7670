# Compiler settings that every target shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Programs are compiled as libraries are, so that they can share precompiled headers.
set(CMAKE_CXX_COMPILE_OPTIONS_PIE -fPIC)

find_program(PERIOST_CCACHE ccache)
if(PERIOST_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PERIOST_CCACHE})
endif()
find_program(PERIOST_MOLD mold)
if(PERIOST_MOLD)
  add_link_options(-fuse-ld=mold)
endif()

# Fused multiply-add would make results depend on what the compiler chose to fuse.
add_compile_options(-ffp-contract=off)
# Nobody replaces our functions at load time, so they may be inlined although the code is position independent.
add_compile_options(-fno-semantic-interposition)

add_library(periost_warnings INTERFACE)
target_compile_options(periost_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-align -Wold-style-cast
  -Wdouble-promotion -Wformat=2 -Wimplicit-fallthrough -Wunused
  $<$<BOOL:${PERIOST_WARNINGS_AS_ERRORS}>:-Werror>)

if(PERIOST_ASSERTIONS)
  add_compile_definitions(PERIOST_ASSERTIONS)
endif()
if(PERIOST_SANITIZE)
  add_compile_options(-fsanitize=${PERIOST_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PERIOST_SANITIZE})
  add_compile_definitions(PERIOST_SANITIZED)
endif()
if(PERIOST_COVERAGE)
  add_compile_options(--coverage -O0)
  add_link_options(--coverage)
endif()

# Lets a target share the headers that another one precompiled. With TOGETHER its sources are compiled several at a time,
# so that large headers are read once for all of them; they must then not define the same name twice.
function(periost_quick_build target owner)
  cmake_parse_arguments(ARG "TOGETHER" "" "" ${ARGN})
  if(NOT PERIOST_QUICK_BUILD)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${owner})
  if(ARG_TOGETHER)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  endif()
endfunction()
