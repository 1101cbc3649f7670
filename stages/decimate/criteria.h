#pragma once
// The paper's three criteria on a simplex mesh (section 4.1), measured as deficits: how far an element misses
// its limit, 0 when it keeps it. A marching-cubes mesh violates the geometric criterion at a tenth of its
// vertices from the start, so a move is judged by the sum over everything it touches, removed elements
// included: that sum must not grow. Where all was well before, all must be well after.
#include <vector>

#include "pipeline/data/isosurface.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/geometry/simplex_walk.h"

namespace periost {

struct Criteria {
  double distance_mm = 0;        // of vertices and face centres to the isosurface
  double min_barycentric = 0.1;  // of every eps
  int topology = 3;              // of |D|
};

// Faces have between three (by construction) and this many vertices.
inline constexpr std::uint32_t kMostVerticesOfAFace = 9;

// Sum over the three barycentric coordinates of v's foot of what they lack to `least`; 1 when v's neighbours
// are collinear.
double barycentric_deficit(const SimplexMesh& mesh, SimplexVertex v, double least);

// How far `p` lies beyond `tolerance_mm` of the part of the isosurface that faces the same way as
// `unit_normal`; tries the normal line, then the exact closest point. Beyond three tolerances, two
// tolerances.
double distance_deficit(const Isosurface& isosurface, Vec3 p, Vec3 unit_normal, double tolerance_mm);
double vertex_distance_deficit(const Isosurface& isosurface, const SimplexMesh& mesh, SimplexVertex v,
                               double tolerance_mm);
// Of the face's centre, along the face's mean normal.
double centre_distance_deficit(const Isosurface& isosurface, const SimplexMesh& mesh, SimplexFace f,
                               double tolerance_mm);

// The deficits of all elements as they stand (contour_model.h measures them); dead elements keep stale
// values. Elements of different components may be updated from different threads.
struct Deficits {
  std::vector<double> barycentric;  // of vertices
  std::vector<double> distance;     // of vertices
  std::vector<double> centre;       // of faces
};

}  // namespace periost
