#pragma once
// One reader for the meshes that `periost quality` measures, whoever made them.
#include <filesystem>
#include <string>

#include "pipeline/io/mesh_builder.h"

namespace periost {

// The format follows from the extension, in any case:
//   .stl .ply .obj .off .vtp    surfaces (surface_read.h)
//   .vtu .vtk                   VTK's XML and legacy files (vtk_mesh_read.h)
//   .msh                        Gmsh 2 and 4.1, ASCII and binary (gmsh_read.h)
//   .inp                        Abaqus and CalculiX (abaqus_deck.h)
//   .ele .node                  TetGen, both files side by side (tetgen_read.h)
// Coordinates are taken as LPS millimetres. Tetrahedra give a TetMesh of one order with its boundary and its
// mid-side nodes in VTK's order, whatever order the format has; a file without tetrahedra gives its surface.
// Points, lines and triangles beside tetrahedra are passed over; other solid elements are refused by name.
// What comes out is finite, and its indices are in range. Throws Error{kInput} as those headers say,
// "mesh.unknown_format" and "mesh.missing". Memory follows from the file's size, never from a count in it.
AnyMesh read_mesh(const std::filesystem::path& path);

// ".stl .ply ...": every extension above, for help texts.
const std::string& mesh_extensions();

}  // namespace periost
