#include "stages/decimate/paper.h"

#include <algorithm>
#include <array>

#include "pipeline/base/parallel.h"
#include "pipeline/base/random.h"
#include "pipeline/geometry/simplex_dual.h"
#include "pipeline/geometry/simplex_operators.h"
#include "stages/decimate/contour_model.h"
#include "stages/decimate/law_of_motion.h"

namespace periost {
namespace {

enum class Operator { kRemoval, kSwap };
enum class Outcome { kAccepted, kRefused, kNotIndicated };

// What all components share; each touches its own entries only.
struct Shared {
  const ContourModel contours;
  const Criteria criteria;
  const MotionOptions motion;
  SimplexMesh& mesh;
  std::vector<std::uint8_t>& may_be_cut;   // of the contours
  const std::vector<std::uint8_t>& start;  // of vertices; empty: all
  Deficits deficits;
  MotionMarks marks;
  std::vector<std::uint8_t> unprocessed;  // label of edge (v, k) at 3 v + k, kept at both of its ends
};

// One component's decimation: the mesh is edited through the journal, so a refused move leaves no trace.
class ComponentDecimator {
 public:
  ComponentDecimator(Shared& shared, const std::vector<SimplexVertex>& vertices, Random random)
      : shared_(shared),
        mesh_(shared.mesh),
        vertices_(vertices),
        random_(random),
        law_(shared.contours.isosurface, shared.motion, shared.marks, &shared.contours) {}

  void run(Progress& progress);
  const DecimationReport& report() const { return report_; }

 private:
  Outcome try_swap(SimplexEdge edge);
  Outcome try_removal(SimplexEdge edge);
  bool deform_and_check(const std::vector<SimplexVertex>& seeds, double removed_barycentric,
                        double removed_distance, double removed_centre);
  bool check_barycentric(double before);
  bool check_distance(double vertices_before, double centres_before);
  bool keeps_contours_on_removal(SimplexEdge edge, const EdgeFaces& f) const;
  bool keeps_contours_on_swap(const EdgeFaces& f) const;
  bool has_chord(SimplexFace face) const;
  bool is_hole(SimplexFace face) const { return shared_.contours.contours.is_over_hole(face); }
  std::uint32_t crowding_of(SimplexFace face) const { return crowding(shared_.contours, mesh_, face); }
  int topology_sum();
  void add_vertices_of(SimplexFace face);
  void commit();
  void swap_around(SimplexFace face);
  void set_label(SimplexEdge edge, bool is_unprocessed);
  void label_around(SimplexVertex v);

  Shared& shared_;
  SimplexMesh& mesh_;
  const std::vector<SimplexVertex>& vertices_;
  Random random_;
  LawOfMotion law_;
  SimplexJournal journal_;
  DecimationReport report_;
  std::vector<SimplexEdge> pool_;  // edges that may be unprocessed; stale entries are skipped when drawn
  // Scratch of the move under test: what it touches and what its deficits would be.
  std::vector<SimplexVertex> seeds_, touched_, around_faces_;
  std::vector<SimplexFace> faces_;
  std::vector<double> barycentric_, distance_, centre_;
  std::vector<SimplexVertex> moved_;
};

std::size_t slot_index(SimplexEdge edge) {
  return 3 * static_cast<std::size_t>(index_of(edge.vertex)) + static_cast<std::size_t>(edge.slot);
}

void ComponentDecimator::set_label(SimplexEdge edge, bool is_unprocessed) {
  const SimplexEdge other = other_end(mesh_, edge);
  shared_.unprocessed[slot_index(edge)] = shared_.unprocessed[slot_index(other)] = is_unprocessed ? 1 : 0;
  if (is_unprocessed) pool_.push_back(edge);
}

void ComponentDecimator::label_around(SimplexVertex v) {
  for (int k = 0; k < 3; ++k) set_label({v, k}, true);
}

void ComponentDecimator::add_vertices_of(SimplexFace face) {
  if (is_hole(face)) return;
  for_each_vertex(mesh_, face, [&](SimplexVertex v) {
    if (std::find(around_faces_.begin(), around_faces_.end(), v) == around_faces_.end())
      around_faces_.push_back(v);
  });
}

// The deficits of every edge at around_faces_ whose D is too low; edges between two of them count twice
// before and after a move alike. An edge whose D is too high is what the swap tests lower, so it is no reason
// to refuse.
int ComponentDecimator::topology_sum() {
  int sum = 0;
  for (const SimplexVertex v : around_faces_) {
    for (int k = 0; k < 3; ++k) {
      const int d = topological_criterion(shared_.contours, mesh_, {v, k});
      sum += std::max(0, -d - shared_.criteria.topology);
    }
  }
  return sum;
}

bool ComponentDecimator::check_barycentric(double before) {
  const double limit = before + 1e-12;
  double after = 0;
  barycentric_.clear();
  for (const SimplexVertex v : touched_) {
    barycentric_.push_back(barycentric_deficit(shared_.contours, mesh_, v, shared_.criteria.min_barycentric));
    after += barycentric_.back();
    if (after > limit) return false;
  }
  return true;
}

bool ComponentDecimator::check_distance(double vertices_before, double centres_before) {
  const double tolerance = shared_.criteria.distance_mm;
  const double slack = 1e-12 * tolerance;
  double after = 0;
  distance_.clear();
  for (const SimplexVertex v : touched_) {
    distance_.push_back(distance_deficit(shared_.contours, mesh_, v, tolerance));
    after += distance_.back();
    if (after > vertices_before + slack) return false;
  }
  after = 0;
  centre_.clear();
  for (const SimplexFace f : faces_) {
    centre_.push_back(centre_deficit(shared_.contours, mesh_, f, tolerance));
    after += centre_.back();
    if (after > centres_before + slack) return false;
  }
  return true;
}

// Sections 4.3 and 4.4 after the operator: deform locally, then compare the criteria on what moved and the
// ring around it. `removed_*` are the deficits of elements that the operator took away.
bool ComponentDecimator::deform_and_check(const std::vector<SimplexVertex>& seeds, double removed_barycentric,
                                          double removed_distance, double removed_centre) {
  moved_ = law_.select(mesh_, seeds);
  gather_neighbourhood(mesh_, moved_, 1, shared_.marks, touched_);
  faces_.clear();
  for (const SimplexVertex v : moved_) {
    journal_.save(mesh_, v);
    for (const SimplexFace f : mesh_.face[index_of(v)]) faces_.push_back(f);
  }
  std::sort(faces_.begin(), faces_.end());
  faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());
  double barycentric_before = removed_barycentric, distance_before = removed_distance,
         centre_before = removed_centre;
  for (const SimplexVertex v : touched_) {
    barycentric_before += shared_.deficits.barycentric[index_of(v)];
    distance_before += shared_.deficits.distance[index_of(v)];
  }
  for (const SimplexFace f : faces_) centre_before += shared_.deficits.centre[index_of(f)];

  law_.deform(mesh_);
  if (!check_barycentric(barycentric_before)) {
    ++report_.rejected_barycentric;
  } else if (!check_distance(distance_before, centre_before)) {
    ++report_.rejected_distance;
  } else {
    return true;
  }
  journal_.undo(mesh_);
  return false;
}

void ComponentDecimator::commit() {
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    shared_.deficits.barycentric[index_of(touched_[i])] = barycentric_[i];
    shared_.deficits.distance[index_of(touched_[i])] = distance_[i];
  }
  for (std::size_t i = 0; i < faces_.size(); ++i) shared_.deficits.centre[index_of(faces_[i])] = centre_[i];
  journal_.clear();
}

// A face over a hole is nobody's to merge or turn: only the edge between a contour vertex and its inner
// neighbour can go, which shortens the contour by an edge. Fixed contours keep every edge, and what sew()
// asks for: two inner vertices to a face.
bool ComponentDecimator::keeps_contours_on_removal(SimplexEdge edge, const EdgeFaces& f) const {
  const ContourModel& model = shared_.contours;
  if (model.contours.empty()) return true;
  if (is_hole(f.left) || is_hole(f.right)) return false;
  const bool left_ends = is_border_face(model, mesh_, f.left),
             right_ends = is_border_face(model, mesh_, f.right);
  for (const SimplexFace opposite : {f.opposite_v, f.opposite_w}) {
    if (!is_hole(opposite) && is_on_fixed_contour(model, mesh_, opposite) && valence_of(mesh_, opposite) <= 4)
      return false;
  }
  const SimplexVertex w = neighbour_of(mesh_, edge.vertex, edge.slot);
  const SimplexVertex on_contour = model.contours.is_on_contour(edge.vertex) ? edge.vertex : w;
  if (!model.contours.is_on_contour(on_contour)) return !(left_ends && right_ends);
  return model.contours.side[index_of(on_contour)] != kFixedContour &&
         !(is_pinned(model, mesh_, f.left) && is_pinned(model, mesh_, f.right));
}

bool ComponentDecimator::keeps_contours_on_swap(const EdgeFaces& f) const {
  const ContourModel& model = shared_.contours;
  if (model.contours.empty()) return true;
  for (const SimplexFace face : {f.left, f.right, f.opposite_v, f.opposite_w}) {
    if (is_hole(face)) return false;
  }
  for (const SimplexFace face : {f.left, f.right}) {
    if (is_on_fixed_contour(model, mesh_, face) && valence_of(mesh_, face) <= 4) return false;
  }
  return !(is_on_fixed_contour(model, mesh_, f.opposite_v) &&
           is_on_fixed_contour(model, mesh_, f.opposite_w));
}

// Whether an edge inside joins `face` to another face of a fixed contour.
bool ComponentDecimator::has_chord(SimplexFace face) const {
  const ContourModel& model = shared_.contours;
  if (model.contours.empty() || !is_on_fixed_contour(model, mesh_, face)) return false;
  bool found = false;
  for_each_vertex(mesh_, face, [&](SimplexVertex v) {
    const int slot = slot_of(mesh_, v, face);
    const SimplexVertex w = neighbour_of(mesh_, v, previous_slot(slot));
    if (model.contours.is_on_contour(v) || model.contours.is_on_contour(w)) return;
    found = found || is_on_fixed_contour(model, mesh_, face_of(mesh_, v, next_slot(slot)));
  });
  return found;
}

// Section 4.3. A swap is indicated where it lowers the sum of (valence - 6)^2: D > 2.
Outcome ComponentDecimator::try_swap(SimplexEdge edge) {
  if (topological_criterion(shared_.contours, mesh_, edge) <= 2) return Outcome::kNotIndicated;
  const EdgeFaces f = faces_of(mesh_, edge);
  if (!keeps_contours_on_swap(f) || legality_of_swap(mesh_, edge) != Legality::kLegal) {
    ++report_.rejected_link;
    return Outcome::kRefused;
  }
  if (crowding_of(f.opposite_v) >= kMostVerticesOfAFace ||
      crowding_of(f.opposite_w) >= kMostVerticesOfAFace) {
    ++report_.rejected_topology;
    return Outcome::kRefused;
  }
  const SimplexEdge turned = swap_edge(mesh_, edge, &journal_).edge;
  const SimplexVertex w = neighbour_of(mesh_, turned.vertex, turned.slot);
  seeds_ = {turned.vertex, w};
  if (!deform_and_check(seeds_, 0, 0, 0)) return Outcome::kRefused;
  commit();
  ++report_.swaps;
  label_around(turned.vertex);
  label_around(w);
  return Outcome::kAccepted;
}

// Section 4.4.
Outcome ComponentDecimator::try_removal(SimplexEdge edge) {
  const EdgeFaces f = faces_of(mesh_, edge);
  if (!keeps_contours_on_removal(edge, f) || legality_of_removal(mesh_, edge) != Legality::kLegal) {
    ++report_.rejected_link;
    return Outcome::kRefused;
  }
  around_faces_.clear();
  for (const SimplexFace face : {f.left, f.right, f.opposite_v, f.opposite_w}) add_vertices_of(face);
  const int topology_before = topology_sum();
  const SimplexVertex v = edge.vertex, w = neighbour_of(mesh_, v, edge.slot);
  const Deficits& d = shared_.deficits;
  const double barycentric = d.barycentric[index_of(v)] + d.barycentric[index_of(w)];
  const double distance = d.distance[index_of(v)] + d.distance[index_of(w)];
  const double centre = d.centre[index_of(f.right)];
  const bool right_is_pinned = is_pinned(shared_.contours, mesh_, f.right);

  const RemovedEdge removed = remove_edge(mesh_, edge, &journal_);
  if (!shared_.may_be_cut.empty() && shared_.may_be_cut[index_of(f.right)] != 0)
    shared_.may_be_cut[index_of(f.left)] = 1;
  if (right_is_pinned) mesh_.dual_position[index_of(f.left)] = mesh_.dual_position[index_of(f.right)];
  if (has_chord(f.left)) {
    ++report_.rejected_link;
    journal_.undo(mesh_);
    return Outcome::kRefused;
  }
  std::erase(around_faces_, v);
  std::erase(around_faces_, w);
  if (crowding_of(f.left) > kMostVerticesOfAFace || topology_sum() > topology_before) {
    ++report_.rejected_topology;
    journal_.undo(mesh_);
    return Outcome::kRefused;
  }
  seeds_.clear();
  for (std::size_t k = 0; k < 3; ++k) {
    if (removed.neighbour_v[k] != w) seeds_.push_back(removed.neighbour_v[k]);
    if (removed.neighbour_w[k] != v) seeds_.push_back(removed.neighbour_w[k]);
  }
  if (!deform_and_check(seeds_, barycentric, distance, centre)) return Outcome::kRefused;
  commit();
  ++report_.removals;
  for (const SimplexVertex x : around_faces_) label_around(x);
  swap_around(f.left);
  return Outcome::kAccepted;
}

// Swap tests on the edges of the new face. Those that fail are labelled processed, the others unprocessed.
void ComponentDecimator::swap_around(SimplexFace face) {
  std::vector<SimplexVertex> corners;
  for_each_vertex(mesh_, face, [&](SimplexVertex v) { corners.push_back(v); });
  for (const SimplexVertex v : corners) {
    const int slot = slot_of(mesh_, v, face);
    if (slot < 0) continue;  // an earlier swap took v off the face
    const SimplexEdge edge{v, next_slot(slot)};
    const Outcome outcome = try_swap(edge);
    if (outcome != Outcome::kAccepted) set_label(edge, outcome == Outcome::kNotIndicated);
  }
}

// Section 4.2.
void ComponentDecimator::run(Progress& progress) {
  const auto is_start = [&](SimplexVertex v, SimplexVertex w) {
    return shared_.start.empty() || shared_.start[index_of(v)] != 0 || shared_.start[index_of(w)] != 0;
  };
  std::vector<SimplexEdge> edges;
  for (const SimplexVertex v : vertices_) {
    for (int k = 0; k < 3; ++k) {
      const SimplexVertex w = neighbour_of(mesh_, v, k);
      if (v < w && is_start(v, w)) edges.push_back({v, k});
    }
  }
  for (const SimplexEdge edge : edges) {
    // An earlier swap may have turned the slot into the other end of its edge: tested all the same, once
    // more.
    try_swap(edge);
  }
  pool_.clear();
  for (const SimplexVertex v : vertices_) {
    for (int k = 0; k < 3; ++k) {
      const SimplexVertex w = neighbour_of(mesh_, v, k);
      if (!is_start(v, w)) continue;
      shared_.unprocessed[slot_index({v, k})] = 1;
      if (v < w) pool_.push_back({v, k});
    }
  }
  while (!pool_.empty()) {
    const std::size_t drawn = random_.below(static_cast<std::uint32_t>(pool_.size()));
    const SimplexEdge edge = pool_[drawn];
    pool_[drawn] = pool_.back();
    pool_.pop_back();
    if (!mesh_.is_live(edge.vertex) || shared_.unprocessed[slot_index(edge)] == 0) continue;
    set_label(edge, false);
    if (try_removal(edge) == Outcome::kAccepted) progress.step(2);
  }
}

// Vertices by component, those to be decimated only.
std::vector<std::vector<SimplexVertex>> decimated_components(const ContouredMesh& model,
                                                             const DecimateOptions& options,
                                                             const std::vector<std::uint8_t>& start) {
  const SimplexComponents components = components_of(model.mesh);
  std::vector<std::vector<SimplexVertex>> vertices(components.count);
  std::vector<int> triangles(components.count, 0);
  std::vector<std::uint8_t> starts(components.count, 0);
  for (std::uint32_t v = 0; v < components.of_vertex.size(); ++v) {
    if (!model.mesh.is_live(SimplexVertex{v})) continue;
    const std::uint32_t c = components.of_vertex[v];
    vertices[c].push_back(SimplexVertex{v});
    triangles[c] += model.contours.is_on_contour(SimplexVertex{v}) ? 0 : 1;
    if (!start.empty() && start[v] != 0) starts[c] = 1;
  }
  for (std::uint32_t c = 0; c < components.count; ++c) {
    const bool is_chosen = start.empty() ? triangles[c] >= options.small_triangles : starts[c] != 0;
    if (!is_chosen) vertices[c].clear();
  }
  std::erase_if(vertices, [](const auto& part) { return part.empty(); });
  return vertices;
}

}  // namespace

void add_counts(DecimationReport& sum, const DecimationReport& part) {
  sum.removals += part.removals;
  sum.swaps += part.swaps;
  sum.rejected_link += part.rejected_link;
  sum.rejected_topology += part.rejected_topology;
  sum.rejected_barycentric += part.rejected_barycentric;
  sum.rejected_distance += part.rejected_distance;
}

void decimate_paper(const Isosurface& isosurface, const DecimateOptions& options, double distance_mm,
                    std::uint64_t seed, const std::vector<std::uint8_t>& start, ContouredMesh& model,
                    Context& context) {
  SimplexMesh& mesh = model.mesh;
  const Criteria criteria{distance_mm, options.min_barycentric, options.topology};
  const MotionOptions motion{options.rigidity, options.stiffness, options.damping, options.iterations,
                             4 * distance_mm};
  const ContourModel contours = contour_model(isosurface, model.contours);
  Shared shared{contours,
                criteria,
                motion,
                mesh,
                model.contours.may_be_cut,
                start,
                measure_deficits(contours, mesh, criteria),
                MotionMarks(mesh.face.size()),
                std::vector<std::uint8_t>(3 * mesh.face.size(), 0)};
  const auto components = decimated_components(model, options, start);
  std::vector<DecimationReport> reports(components.size());
  Progress progress(context, "decimate", mesh.face.size());
  parallel_for(context, components.size(), [&](std::size_t i) {
    ComponentDecimator component(shared, components[i], Random(seed, i));
    component.run(progress);
    reports[i] = component.report();
  });
  for (const DecimationReport& report : reports) add_counts(mesh.report, report);
  for (const auto& part : components) {
    for (const SimplexVertex v : part) {
      if (!mesh.is_live(v)) continue;
      for (const SimplexFace f : mesh.face[index_of(v)])
        mesh.dual_position[index_of(f)] = dual_place(contours, mesh, f);
    }
  }
}

}  // namespace periost
