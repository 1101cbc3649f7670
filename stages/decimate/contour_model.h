#pragma once
// Contours under `method: paper`: a contour is a deformable 1-simplex mesh in its plane of the image border,
// under the same law of motion and criteria as the surface, one dimension down. A vertex P between its
// contour neighbours A and B has the metric parameters of its foot on AB, and its angle and height obey the
// surface's formulas with power eps_A eps_B |AB|^2 and radius |AB| / 2 (Delingette 1994). The triangulation's
// border points lie midway between contour vertices, as its other points lie at face centres; a point in a
// corner of the image border, between contour vertices on different planes, stays where it is.
#include "pipeline/data/isosurface.h"
#include "pipeline/geometry/simplex_contour.h"
#include "pipeline/geometry/simplex_geometry.h"
#include "stages/decimate/criteria.h"

namespace periost {

// A mesh's contours with the isosurface that they belong to. Both must outlive it.
struct ContourModel {
  const Isosurface& isosurface;
  const Contours& contours;
  std::vector<std::uint8_t> open;  // open_sides(isosurface.surface); empty if there are no contours
};
ContourModel contour_model(const Isosurface& isosurface, const Contours& contours);

// Whether f is cut by a contour, and its point of the triangulation must stay at dual_position.
bool is_border_face(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f);
bool is_pinned(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f);
// The face on one fixed contour at least.
bool is_on_fixed_contour(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f);

// Where the triangulation's point of f belongs.
Vec3 dual_place(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f);

// Of a contour vertex: along its contour, the surface on the left; not normalised.
Vec3 contour_direction(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v);
// Unit normal of a contour that runs along `direction` on a border plane, in that plane, away from the inside
// of the surface. Precondition: side < kFixedContour.
Vec3 contour_normal(const ContourModel& model, std::uint8_t side, Vec3 direction);
// Its parameters; barycentric[0..1] are those of its neighbours 0 and 1, the third is 0. Precondition: its
// contour is not fixed.
SimplexParameters contour_parameters(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v);
// p moved onto the border plane of a side. Precondition: side < kFixedContour.
Vec3 on_border_plane(const GridFrame& frame, std::uint8_t side, Vec3 p);

// The criteria of section 4.1 on any element (criteria.h). On a contour the barycentric coordinates are the
// two along it, and distances are to the isosurface's border curve. 0 where nothing can move: on fixed
// contours, at pinned points, over holes.
double barycentric_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v, double least);
double distance_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexVertex v,
                        double tolerance_mm);
double centre_deficit(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f, double tolerance_mm);
Deficits measure_deficits(const ContourModel& model, const SimplexMesh& mesh, const Criteria& criteria);

// Valences as the topological criterion sees them: a face of k inner vertices on a contour counts k + 3, so
// that three, straight on, count six; on a fixed contour 2 k, since the other side will add as many.
std::uint32_t crowding(const ContourModel& model, const SimplexMesh& mesh, SimplexFace f);
// D with these valences; 0 for an edge with a hole beside or across it.
int topological_criterion(const ContourModel& model, const SimplexMesh& mesh, SimplexEdge edge);

}  // namespace periost
