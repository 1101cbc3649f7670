#pragma once
// Fills a closed surface with tetrahedra by TetGen (Si 2015), which runs in a process of its own
// (workers/tetgen): it may crash, hang or run out of memory without harm to us.
#include <filesystem>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/base/quantity.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

// What becomes of the hollow inside a body.
enum class Cavities {
  kEmpty,   // it stays a hole
  kFilled,  // it is meshed as well, as a region of its own with its faces shared
};

// Which way x and y of a point run; z runs to superior in both.
enum class SizeFrame { kLps, kRas };

// A ball in which the mesh is to be fine.
struct SizeBall {
  Vec3 at;          // its centre, mm
  Length radius{};  // 0: the centre only
  Length size{};    // largest edge inside it
  SizeFrame frame = SizeFrame::kLps;
};

// Where the mesh is to be how fine, as the largest edge of a tetrahedron. What is asked for at one place
// holds around it, too, as far as `gradation` lets it grow, and the smallest of all wishes counts. With
// nothing set TetGen's own growth decides.
struct SizeOptions {
  Length inside{};               // far from the surface; 0: no limit
  Length near_surface{};         // at the surface; 0: what goes with the surface's edges
  double gradation = 0.3;        // by how much the largest edge may grow on a way of 1
  std::vector<SizeBall> around;  // around points
  std::filesystem::path field;   // an image of largest edges in mm; voxels of 0 ask for nothing

  bool is_any() const {
    return inside.value > 0 || near_surface.value > 0 || !around.empty() || !field.empty();
  }
};

struct TetgenOptions {
  double max_radius_edge = 1.4;         // largest ratio of circumradius to shortest edge
  Angle min_dihedral = Angle::deg(10);  // smallest dihedral angle that refinement aims at
  double max_volume = 0;                // largest tetrahedron, mm^3; 0: no limit
  SizeOptions sizes;                    // largest edges by place
  Cavities cavities = Cavities::kEmpty;
  bool preserve_surface = true;      // keep every triangle; else TetGen may split them
  int order = 1;                     // 2: with mid-side nodes, on straight edges
  bool curved = false;               // order 2: the boundary's mid-side nodes on the isosurface (the stage's)
  double min_jacobian = 0.5;         // no element may fall below it by that: smallest J / largest |J|
  Angle optimise = Angle::deg(140);  // dihedral angles above it are worked on at the end; 0: not at all
  double time_limit = 900;           // seconds for all attempts
  ByteSize memory_limit{0};          // of the worker; 0: what context.memory_bytes allows
};

// First the surface is checked on its own: finite, closed, manifold, oriented, no triangle without area, no
// self-intersection (exactly). What is wrong is named in mm and drawn in `surface_faults.vtp` in
// context.output. Shells inside shells are cavities and bodies in turn, whatever their normals say.
//
// The result: points of the surface first, in its order (those that no triangle uses left out), with the same
// bits; tetrahedra of positive volume in VTK's order; `region` is the number of the separate body, from 1 in
// the order of the bodies' first triangles, and behind these of each filled cavity likewise; `boundary`
// outward; `boundary_preserved` as measured, on walls of filled cavities, too. It depends on surface and
// options only. Units LPS mm.
//
// Errors, by kind and code:
//   kQuality, or kInput if surface.was_read: surface.not_finite, surface.open, surface.not_manifold,
//       surface.misoriented, surface.degenerate, surface.self_intersection, surface.empty
//   kExternal: tetgen.worker_missing, tetgen.worker_died, tetgen.failed
//   kLimit: tetgen.memory, tetgen.time     kInterrupted: the worker is ended with us
// Memory: about 0.25 kB a tetrahedron in the worker, limited to context.memory_bytes if that is given.
TetMesh tetrahedralize(const SurfaceMesh& surface, const TetgenOptions& options, const Context& context);

}  // namespace periost
