#include "stages/decimate/certificate_ring.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace periost {
namespace {

constexpr double kFlat = 1e-7;  // shadows of triangles with less area than this, per squared edge
constexpr int kFanWalk = 256;
constexpr std::size_t kFanFlood = 4096;
constexpr std::uint32_t kApex = std::uint32_t{1} << 31;  // among the bits of a fan's vertices
// Of the first new triangle, in general position; the degree is measured there.
constexpr std::array<double, 2> kFanProbe{0.328759, 0.334138};

// Bit i: whether values[i] is negative, -0 included. `count`: at most 32, and a place more may be read.
#if defined(__SSE2__)
std::uint32_t sign_bits(const double* values, std::size_t count) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < count; i += 2) {
    bits |= static_cast<std::uint32_t>(_mm_movemask_pd(_mm_loadu_pd(values + i))) << i;
  }
  return bits & static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1);
}
#else
std::uint32_t sign_bits(const double* values, std::size_t count) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= static_cast<std::uint32_t>(std::signbit(values[i])) << i;
  return bits;
}
#endif

// One overlay. The patch grows visit by visit; what each adds is looked at once.
class FanOverlay {
 public:
  FanOverlay(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal, const Fan& fan,
             double tolerance, ForwardScratch& forward, RingScratch& scratch)
      : reference_(reference),
        mesh_(mesh),
        proposal_(proposal),
        fan_(fan),
        tolerance_(tolerance),
        forward_(forward),
        scratch_(scratch) {}

  Answer run(Index start) {
    reset();
    const Vec3 a = fan_.rim[fan_.cell[0].a], b = fan_.rim[fan_.cell[0].b];
    probe_ = {kFanProbe[0] * a.x + kFanProbe[1] * b.x, kFanProbe[0] * a.y + kFanProbe[1] * b.y};
    const Index seed = walk(start);
    if (seed == kNoIndex) return Answer::kUnknown;
    place_common_vertices();
    push(seed);
    for (std::size_t i = 0; i < scratch_.visits.size(); ++i) {
      const bool goes_on = visit(i);
      if (is_refuted_) return Answer::kRefuted;
      if (!goes_on) return Answer::kUnknown;
    }
    scratch_.is_complete = true;
    if (degree_ < 1) return Answer::kUnknown;
    return Answer::kProved;
  }

 private:
  using Foot = RingScratch::Foot;

  void reset() {
    scratch_.visits.clear();
    if (scratch_.foot_of.empty() || ++scratch_.tick == 0) {
      scratch_.foot_of.assign(reference_.points.size(), {});
      scratch_.visit_of.assign(reference_.triangles.size(), {});
      scratch_.tick = 1;
    }
  }

  // Over the isosurface to the triangle under the probe; kNoIndex when it folds back or has a contour.
  Index walk(Index t) const {
    for (int step = 0; step < kFanWalk && t != kNoIndex; ++step) {
      std::array<Planar, 3> p;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 q = fan_.to_fan(reference_.points[reference_.triangles[t].corner[k]]);
        p[k] = {q.x - probe_.x, q.y - probe_.y};
      }
      double worst = 0;
      std::size_t exit = 3;
      for (std::size_t k = 0; k < 3; ++k) {
        const double side = planar_turn(p[(k + 1) % 3], p[(k + 2) % 3]);
        if (side < worst) {
          worst = side;
          exit = k;
        }
      }
      if (exit == 3) return t;
      t = reference_.triangles[t].across[exit];
    }
    return kNoIndex;
  }

  std::uint32_t push(Index t) {
    const auto number = static_cast<std::uint32_t>(scratch_.visits.size());
    scratch_.visit_of[t] = {scratch_.tick, number};
    scratch_.visits.push_back({t, 0, false, false, {}});
    return number;
  }

  // A corner of the overlay with these new triangles. One that is too high leaves them open, and whether they
  // are within the tolerance all the same is asked at once: most moves that fail end here. True when it is
  // too high.
  bool note(std::uint32_t cells, double height) {
    if (std::abs(height) <= tolerance_) return false;
    for (std::uint32_t left = cells & ~scratch_.unproved; left != 0 && !is_refuted_; left &= left - 1) {
      const LinkedTriangle& cell = proposal_.cells[static_cast<std::size_t>(std::countr_zero(left))];
      is_refuted_ = !certify_forward(reference_, dual_triangle(mesh_, proposal_, cell), tolerance_, forward_);
    }
    scratch_.unproved |= cells;
    return true;
  }

  // An isosurface vertex in the fan's frame, and on which side of each line; the caller knows no foot of it.
  std::uint32_t place_foot(Index v) {
    const std::uint32_t number = foot_count_++;
    scratch_.foot_of[v] = {scratch_.tick, number};
    if (number == scratch_.feet.size()) scratch_.feet.resize(2 * scratch_.feet.size() + 64);
    Foot& foot = scratch_.feet[number];
    const Vec3 q = fan_.to_fan(reference_.points[v]);
    foot.x = q.x;
    foot.y = q.y;
    foot.z = q.z;
    const std::size_t lines = fan_.lines();
    for (std::size_t l = 0; l < lines; ++l) foot.offset[l] = fan_.cx[l] * q.x + fan_.cy[l] * q.y + fan_.c[l];
    foot.sides =
        ~sign_bits(foot.offset.data(), lines) & static_cast<std::uint32_t>((std::uint64_t{1} << lines) - 1);
    foot.cell = foot.inside = foot.vertex = foot.touched = 0;
    foot.is_high = false;
    return number;
  }

  // The fan's vertices that are still vertices of the isosurface: they have the same number and place.
  void place_common_vertices() {
    const auto is_common = [&](Index v) {
      return v != proposal_.moved && v < reference_.points.size() && mesh_.points[v] == reference_.points[v];
    };
    for (std::size_t i = 0; i < fan_.spokes; ++i) {
      if (!is_common(fan_.vertex[i])) continue;
      Foot& foot = scratch_.feet[place_foot(fan_.vertex[i])];
      foot.cell = fan_.cells_at[i];
      foot.vertex = 1u << i;
      foot.touched = fan_.lines_at[i];
    }
    if (const Index apex = apex_of(proposal_); is_common(apex)) {
      Foot& foot = scratch_.feet[place_foot(apex)];
      foot.cell = (1u << fan_.cells) - 1;
      foot.vertex = kApex;
      foot.touched = (1u << fan_.spokes) - 1;
    }
  }

  // The vertex in the fan's frame, and over which new triangle it lies.
  std::uint32_t foot(Index v) {
    const auto mark = scratch_.foot_of[v];
    if (mark.stamp == scratch_.tick) return mark.at;
    const std::uint32_t number = place_foot(v);
    Foot& foot = scratch_.feet[number];
    const std::uint32_t inside =
        fan_.of_first(foot.sides) & ~fan_.of_second(foot.sides) & foot.sides >> fan_.spokes;
    if (inside != 0) {
      const auto j = static_cast<std::size_t>(std::countr_zero(inside));
      foot.cell = foot.inside = 1u << j;
      foot.is_high = note(foot.cell, foot.z - fan_.height(j, {foot.x, foot.y}));
    }
    return number;
  }

  // The lines of the fan whose segments are crossed by the line through two feet.
  std::uint32_t lines_across(const Foot& a, const Foot& b) const {
    const double x = b.x - a.x, y = b.y - a.y, at_apex = y * a.x - x * a.y;
    std::array<double, kMaxFan + 2> turn{};
    for (std::size_t i = 0; i < fan_.spokes; ++i) turn[i] = at_apex + (x * fan_.rim_y[i] - y * fan_.rim_x[i]);
    const std::uint32_t right = sign_bits(turn.data(), fan_.spokes);  // of spokes' ends, seen from a to b
    const std::uint32_t borders = fan_.of_first(right) ^ fan_.of_second(right);
    const std::uint32_t spokes = std::signbit(at_apex) ? ~right : right;
    return (spokes & fan_.all_spokes()) | borders << fan_.spokes;
  }

  // The crossings of an isosurface edge with the fan's; whether its shadow meets the fan's.
  bool cross_lines(const Foot& a, const Foot& b, RingScratch::Visit& seen) {
    const std::uint32_t common = a.cell & b.cell;
    if (common != 0 && a.vertex != 0 &&
        b.vertex != 0) {  // an edge of both: of one new triangle, or between two
      seen.cells = common;
      return (common & (common - 1)) != 0;
    }
    if (common != 0) return true;  // both in one new triangle, which is convex
    bool meets = (a.inside | b.inside) != 0;
    // With both ends outside, spokes are reached over the border only, whose lines come last.
    const std::uint32_t border =
        fan_.spokes == fan_.cells ? ~std::uint32_t{0} << fan_.spokes : ~std::uint32_t{0};
    std::uint32_t crossed = (a.sides ^ b.sides) & ~(a.touched | b.touched);
    if (crossed == 0) return meets;
    crossed &= lines_across(a, b);
    for (std::uint32_t left = crossed; left != 0; left ^= std::bit_floor(left)) {
      if (!meets && (left & border) == 0) break;
      const auto l = static_cast<std::size_t>(std::bit_width(left) - 1);
      const auto& line = fan_.line[l];
      const double t = a.offset[l] / (a.offset[l] - b.offset[l]);
      const Planar p{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      const Planar d = p - line.from;
      const double w = (d.x * line.along.x + d.y * line.along.y) * line.per_squared_length;
      meets = true;
      seen.cells |= line.cells;
      seen.leaves |= line.is_border;
      if (note(line.cells, a.z + t * (b.z - a.z) - (line.height + w * line.rise))) seen.is_high = true;
    }
    return meets;
  }

  // Whether p lies in the shadow of the triangle; then its height over p.
  static bool height_at(const std::array<const Foot*, 3>& f, Planar p, double& height, int& orientation) {
    std::array<Planar, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = {f[k]->x - p.x, f[k]->y - p.y};
    const double w0 = planar_turn(q[1], q[2]), w1 = planar_turn(q[2], q[0]), w2 = planar_turn(q[0], q[1]);
    if (!((w0 >= 0 && w1 >= 0 && w2 >= 0) || (w0 <= 0 && w1 <= 0 && w2 <= 0))) return false;
    const double area = w0 + w1 + w2;
    const Planar e1 = q[1] - q[0], e2 = q[2] - q[0];
    const double size = std::max(e1.x * e1.x + e1.y * e1.y, e2.x * e2.x + e2.y * e2.y);
    height = std::abs(area) < kFlat * size ? std::numeric_limits<double>::infinity()
                                           : (w0 * f[0]->z + w1 * f[1]->z + w2 * f[2]->z) / area;
    // Counted at once by two neighbours when exactly on an edge: then it counts for nothing.
    orientation = w0 > 0 && w1 > 0 && w2 > 0 ? 1 : area > 0 ? 0 : -1;
    return true;
  }

  // The fan's vertices over the triangle.
  void place_fan_vertices(RingScratch::Visit& visit, const std::array<const Foot*, 3>& f) {
    const std::uint32_t any = f[0]->sides | f[1]->sides | f[2]->sides;
    const std::uint32_t mixed = any & ~(f[0]->sides & f[1]->sides & f[2]->sides);
    const std::uint32_t all_spokes = fan_.all_spokes();
    const std::uint32_t own = f[0]->vertex | f[1]->vertex | f[2]->vertex;
    double height = 0;
    int orientation = 0;
    if ((mixed & all_spokes) == all_spokes && (own & kApex) == 0 &&
        height_at(f, {0, 0}, height, orientation)) {
      const std::uint32_t all_cells = (1u << fan_.cells) - 1;
      visit.cells |= all_cells;
      visit.leaves = visit.leaves || fan_.spokes != fan_.cells;
      visit.is_high = note(all_cells, height) || visit.is_high;
    }
    for (std::uint32_t left = fan_.ends_of(mixed) & ~own; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      const Planar p{fan_.rim[i].x, fan_.rim[i].y};
      if (!height_at(f, p, height, orientation)) continue;
      visit.cells |= fan_.cells_at[i];
      visit.leaves = true;
      visit.is_high = note(fan_.cells_at[i], height - fan_.rim[i].z) || visit.is_high;
    }
    if ((visit.cells & 1u) != 0 && height_at(f, probe_, height, orientation)) degree_ += orientation;
  }

  // False at a contour, or when the patch is too large.
  bool visit(std::size_t i) {
    const Index t = scratch_.visits[i].triangle;
    const LinkedTriangle& triangle = reference_.triangles[t];
    std::array<std::uint32_t, 3> number;
    for (std::size_t k = 0; k < 3; ++k) number[k] = foot(triangle.corner[k]);
    const std::array<const Foot*, 3> f{&scratch_.feet[number[0]], &scratch_.feet[number[1]],
                                       &scratch_.feet[number[2]]};
    scratch_.visits[i].foot = number;
    scratch_.visits[i].cells |=
        (f[0]->cell & f[1]->cell & f[2]->cell) | f[0]->inside | f[1]->inside | f[2]->inside;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index next = triangle.across[k];
      const RingScratch::Mark known = next == kNoIndex ? RingScratch::Mark{} : scratch_.visit_of[next];
      const bool is_known = known.stamp == scratch_.tick;
      if (is_known && known.at < i) continue;  // looked at from there
      RingScratch::Visit seen{};
      if (!cross_lines(*f[(k + 1) % 3], *f[(k + 2) % 3], seen)) continue;
      if (next == kNoIndex || scratch_.visits.size() > kFanFlood) return false;
      for (const std::size_t j : {i, std::size_t{is_known ? known.at : push(next)}}) {
        scratch_.visits[j].add(seen);
      }
    }
    place_fan_vertices(scratch_.visits[i], f);
    return true;
  }

  const Reference& reference_;
  const CertifiedMesh& mesh_;
  const Proposal& proposal_;
  const Fan& fan_;
  double tolerance_;
  ForwardScratch& forward_;
  RingScratch& scratch_;
  Planar probe_{};
  int degree_ = 0;
  bool is_refuted_ = false;
  std::uint32_t foot_count_ = 0;
};

}  // namespace

DualTriangle dual_triangle(const CertifiedMesh& mesh, const Proposal& proposal, const LinkedTriangle& cell) {
  DualTriangle triangle{};
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.corner[k] = proposal.point_of(mesh, cell.corner[k]);
    triangle.nearest[k] = proposal.nearest_of(mesh, cell.corner[k]);
  }
  return triangle;
}

Answer certify_ring(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal,
                    double tolerance, ForwardScratch& forward, RingScratch& scratch) {
  scratch.unproved = 0;
  scratch.is_complete = false;
  Fan fan;
  if (!make_fan(mesh, proposal, fan)) return Answer::kUnknown;
  const Index start = proposal.nearest_of(mesh, apex_of(proposal));
  return FanOverlay(reference, mesh, proposal, fan, tolerance, forward, scratch).run(start);
}

bool is_covered_by_ring(const Proposal& proposal, const RingScratch& scratch, Index s, ReverseProof& proof) {
  const RingScratch::Visit* const visit = scratch.find_visit(s);
  if (!visit || visit->leaves || visit->is_high || std::popcount(visit->cells) > 4) return false;
  std::uint32_t home = 0;
  for (const std::uint32_t number : visit->foot) {
    const RingScratch::Foot& foot = scratch.feet[number];
    if (foot.cell == 0 || foot.is_high) return false;
    if (foot.vertex == 0) home = foot.cell;
  }
  if (home == 0) home = visit->cells & (~visit->cells + 1);
  if (home == 0) return false;
  const auto id = [&](std::uint32_t bit) {
    return proposal.after[static_cast<std::size_t>(std::countr_zero(bit))];
  };
  proof = {id(home), {kNoIndex, kNoIndex, kNoIndex}};
  std::size_t count = 0;
  for (std::uint32_t left = visit->cells & ~home; left != 0; left &= left - 1) {
    proof.label[count++] = id(left & (~left + 1));
  }
  return true;
}

}  // namespace periost
