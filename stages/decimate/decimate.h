#pragma once
// Decimation of an isosurface as a deformable simplex mesh (Delingette, Decimation of Isosurfaces with
// Deformable Models). Two schemes share the mesh, the operators, the law of motion and the three criteria:
// `paper` follows sections 4.2 to 4.4 to the letter (paper.h), `certified` proves the distance of the final
// triangulation in both directions (certified.h). docs/decimation.md compares them.
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/base/context.h"
#include "pipeline/base/quantity.h"
#include "pipeline/data/isosurface.h"
#include "pipeline/data/simplex_mesh.h"

namespace periost {

enum class DecimateMethod { kCertified, kPaper };
// How far the isosurface may lie from the mesh, seen from the isosurface.
enum class ReverseDistance { kNone, kOnce, kTwice };
enum class SmallComponents { kKeep, kDrop };

// Short edges around a place, say where a load will act.
struct EdgeLimit {
  Vec3 point;         // LPS mm
  double radius = 0;  // mm
  Length max_edge;    // longest edge of triangles within it
  friend bool operator==(const EdgeLimit&, const EdgeLimit&) = default;
};

struct DecimateOptions {
  DecimateMethod method = DecimateMethod::kCertified;
  Length distance = Length::voxel(0.3);  // isosurface distance criterion (section 4.1)
  double min_barycentric = 0.1;          // geometric criterion: least eps_i^k; at most 1/3
  int topology = 3;                      // topological criterion: greatest |D|, the paper's T
  int rigidity = 1;                  // s_i: extent of the neighbourhood Q^s that the internal force smooths
  double stiffness = 0.5;            // beta_i: pull towards the isosurface, against smoothness
  double damping = 0.65;             // gamma of equation (1)
  int iterations = 5;                // of the law of motion after each operator
  Angle min_angle = Angle::deg(30);  // certified only: smallest angle of the dual triangles
  Angle min_edge_angle = Angle::deg(20);  // certified only: least interior dihedral angle, outside or inside
  double grading = 0;               // certified only: greatest ratio of neighbours' longest edges; 0: any
  Length max_edge = Length::mm(0);  // certified only: longest edge; 0: any
  double edge_per_thickness = 0;    // certified only: longest edge over thickness of wall or gap; 0: any
  std::vector<EdgeLimit> refine;    // certified only
  ReverseDistance reverse = ReverseDistance::kOnce;  // certified only: tolerance of the reverse distance
  std::size_t max_triangles = 0;  // certified only: then only angles are mended; 0: to the end
  int rounds = 0;                 // certified only: last rounds of removals; 0: as many as the size allows
  SmallComponents small_components = SmallComponents::kKeep;  // what to do with tiny closed surfaces
  int small_triangles = 100;                                  // a component with fewer triangles is tiny
  // Parts decimated apart along image planes and sewn; 0: one, or with `certified` what keeps to the budget.
  int pieces = 0;
  std::uint64_t seed = 0;  // of the random order of edges; 0: the run's seed
};

// The decimated model: every component of `isosurface` by itself, its Euler number unchanged, no dead
// elements, the report filled in. Dual positions are the triangulation's vertices. An open surface keeps its
// contours, with fewer edges: those on the image border stay on their planes. Deterministic: a
// function of the arguments and context.seed only, whatever context.threads. Tiny components that are dropped
// are taken out first: no distance counts to them. An isosurface without voxels (a surface that was read) is
// decimated by `certified`, whole. Throws Error{kQuality, "surface.not_manifold"} with the place; {kUsage,
// "decimate.no_voxel"} when an option needs voxels and there are none; {kInterrupted}.
SimplexMesh decimate(const Isosurface& isosurface, const DecimateOptions& options, Context& context);

}  // namespace periost
