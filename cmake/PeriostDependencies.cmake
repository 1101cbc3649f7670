# Third parties, all Debian packages. One third party, one folder: see ARCHITECTURE.md.
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(ZLIB REQUIRED)
# The bare call would look for Qt and MPI: components are always named.
find_package(VTK 9.1 REQUIRED COMPONENTS CommonCore CommonDataModel CommonExecutionModel IOCore IOXML IOGeometry IOPLY
             IOLegacy ImagingCore ImagingGeneral ImagingMorphological)

find_path(PERIOST_XXHASH_INCLUDE xxhash.h REQUIRED)
find_library(PERIOST_XXHASH_LIBRARY xxhash REQUIRED)
add_library(periost_xxhash INTERFACE)
target_include_directories(periost_xxhash SYSTEM INTERFACE ${PERIOST_XXHASH_INCLUDE})
target_link_libraries(periost_xxhash INTERFACE ${PERIOST_XXHASH_LIBRARY})
