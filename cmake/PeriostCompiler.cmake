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

# Gives a target the headers that periost_framework precompiled.
function(periost_precompile target)
  if(PERIOST_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM periost_framework)
  endif()
endfunction()
