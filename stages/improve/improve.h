#pragma once
// Raises the dihedral angles of a tetrahedral mesh. TetGen leaves slivers: tetrahedra of good edges that are
// nearly flat. Worst first, a tetrahedron below the target is attacked by taking out its edges and faces
// (tet_removal.h), by moving its points inside the body (tet_smoothing.h), by putting a new point into a
// cavity around it (tet_cavity.h), and, if that is allowed, by sliding its points on the boundary
// (slide_trial.h). The measure is the smallest sine of the six dihedral angles (sine_quality.h), so angles
// near 0 and near 180 degrees are worked on alike; needles count as bad, too. No step is taken unless the
// measure of the worst tetrahedron concerned rises: the worst of the mesh never gets worse.
// After Klingner and Shewchuk, Aggressive tetrahedral mesh improvement (2007).
#include "pipeline/base/context.h"
#include "pipeline/base/quantity.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/data/surface_mesh.h"
#include "pipeline/data/tet_mesh.h"

namespace periost {

enum class BoundaryMotion {
  kFixed,  // points on the boundary stay
  kSlide,  // they may move where nothing else helps, within the tolerance
};

struct ImproveOptions {
  Angle target = Angle::deg(30);  // dihedral angles below it, or above 180 deg less it, are worked on
  BoundaryMotion boundary = BoundaryMotion::kSlide;
  Length tolerance = Length::mm(0);  // largest distance to the isosurface after sliding; 0: the decimator's
  bool split_thin = false;           // put points between the two sides of thin walls
  double max_growth = 0.15;          // of the number of tetrahedra, as a share of it
  bool curved = false;        // second order: the boundary's mid-side nodes on the isosurface (the stage's)
  double min_jacobian = 0.5;  // no element may fall below it by that: smallest J / largest |J|
};

// What a slid boundary is compared with; null for what the chain did not make.
struct ImproveInputs {
  const Isosurface* isosurface = nullptr;     // the reference; without it, the boundary as it comes in
  const SimplexMesh* simplex_mesh = nullptr;  // for the distance that the decimator was asked
  const SurfaceMesh* surface = nullptr;       // what the mesh was made from; comes out again, moved
};

struct ImproveResult {
  TetMesh mesh;
  SurfaceMesh surface;
};

// The improved mesh, and the surface that bounds it now.
//
// Mesh: tetrahedra of positive volume; the smallest measure is not below the input's; points on the boundary
// and boundary triangles keep their order (points inside may vanish, new ones come last); each tetrahedron
// keeps to one region, and faces between regions stay as they are. A second-order mesh is improved by its
// corners and gets new mid-side nodes on straight edges. Fields are dropped: their elements exist no more.
//
// Surface: `inputs.surface` with its moved points where the mesh's boundary, with the faces between its
// regions, is that surface, triangle by triangle; else the boundary of the mesh. With kFixed nothing of it
// moves, to the last bit. With kSlide, for every triangle that changes: its normal turns by at most 20
// degrees in all; its angles stay at 25 degrees or as they were; it meets no other triangle (exactly); all of
// it lies within the tolerance of the reference, and all of the reference that was within the tolerance of it
// still is within that of the surface. The last two are bounds on whole triangles, not samples. Points
// between regions do not slide. Without a tolerance (neither given nor known from a decimator) the boundary
// stays fixed, and the log says so.
//
// A function of its arguments alone, the same bits for any number of threads (which sliding and the search
// for new points use). Linear in practice: some 10 microseconds a tetrahedron that TetGen leaves, and up to a
// millisecond a point that slides. Memory: about 200 bytes a tetrahedron. Errors: {kQuality,
// "improve.inverted"} with the place, for a tetrahedron without positive volume; {kUsage, "improve.no_voxel"}
// for a tolerance in voxels without an image behind it; {kInterrupted}.
ImproveResult improve(const TetMesh& mesh, const ImproveInputs& inputs, const ImproveOptions& options,
                      const Context& context);

}  // namespace periost
