#pragma once
// The law of motion of the deformable model (paper, equation (1), section 2.2), on a part of a simplex mesh:
//   P <- P + (1 - gamma) (P - P_previous) + F_int + F_ext
//   F_int = 1/2 (centroid of neighbours - F) + 1/2 (L(phi_mean) - h) n   simplex-angle continuity, where F is
//           the foot of P, n the normal of its neighbours, and phi_mean the mean angle over Q^s(P)
//   F_ext = beta (M - P), along n, with M the isosurface point on the normal line (section 3.2)
// All forces of a step are taken before any vertex moves, so the order of vertices does not matter. Contour
// vertices obey the same law in their plane of the image border (contour_model.h): P's neighbours are the two
// along the contour, Q^s is the part of the contour on that plane, M lies on the isosurface's border curve.
#include <cstdint>
#include <vector>

#include "pipeline/data/isosurface.h"
#include "pipeline/data/simplex_mesh.h"
#include "pipeline/geometry/simplex_geometry.h"

namespace periost {

struct ContourModel;

struct MotionOptions {
  int rigidity = 1;        // s: Q^s is what lies within s edges; 0 keeps the vertex's own angle
  double stiffness = 0.5;  // beta
  double damping = 0.65;   // gamma; 1: no inertia
  int iterations = 5;
  double reach_mm = 0;  // how far along the normal M is searched; beyond it there is no external force
};

// Shared scratch of one number per vertex. Several LawOfMotion objects may share it while they work on
// different components.
struct MotionMarks {
  std::vector<std::uint32_t> local;  // position in the list being built, or kNoIndex
  explicit MotionMarks(std::size_t vertices) : local(vertices, kNoIndex) {}
};

// Q^s of a set of vertices: the seeds and everything within `extent` edges, breadth first. The marks come
// back as they were. Result replaces `out`.
void gather_neighbourhood(const SimplexMesh& mesh, const std::vector<SimplexVertex>& seeds, int extent,
                          MotionMarks& marks, std::vector<SimplexVertex>& out);

class LawOfMotion {
 public:
  // `contours` may be null for a mesh that has none.
  LawOfMotion(const Isosurface& isosurface, const MotionOptions& options, MotionMarks& marks,
              const ContourModel* contours = nullptr)
      : isosurface_(isosurface), options_(options), marks_(marks), contours_(contours) {}

  // Selects the vertices to move: Q^s of the seeds (of the seeds themselves at rigidity 0), without those of
  // fixed contours. Precondition: every vertex has three neighbours; contours are closed
  // (geometry/simplex_contour.h).
  const std::vector<SimplexVertex>& select(const SimplexMesh& mesh, const std::vector<SimplexVertex>& seeds);
  // Moves the selected vertices by `iterations` steps. O(iterations * moved * |Q^s|).
  void deform(SimplexMesh& mesh);

 private:
  // The plane that stands for the isosurface around a vertex after the first step's line search.
  struct Target {
    Vec3 point;
    Vec3 normal;
    bool found = false;
  };
  Target find_target(Vec3 p, Vec3 normal) const;
  std::uint8_t side_of(SimplexVertex v) const;
  Target find_contour_target(const SimplexMesh& mesh, std::size_t i) const;
  void build_samples(const SimplexMesh& mesh);
  SimplexParameters parameters_of(const SimplexMesh& mesh, SimplexVertex v) const;
  void measure(const SimplexMesh& mesh);
  Vec3 middle_of_neighbours(const SimplexMesh& mesh, SimplexVertex v) const;
  Vec3 force_on(const SimplexMesh& mesh, std::size_t i) const;

  const Isosurface& isosurface_;
  MotionOptions options_;
  MotionMarks& marks_;
  const ContourModel* contours_;
  std::vector<SimplexVertex> moved_;       // begins sampled_
  std::vector<SimplexVertex> sampled_;     // union of Q^s over moved_
  std::vector<std::uint32_t> first_, of_;  // Q^s of moved vertex i: sampled_[of_[first_[i] .. first_[i + 1])]
  std::vector<SimplexParameters> parameters_;  // of sampled_
  std::vector<double> angle_;                  // of sampled_
  std::vector<Target> target_;                 // of moved_
  std::vector<Vec3> previous_, next_;          // of moved_
};

}  // namespace periost
