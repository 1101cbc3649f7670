#include "stages/decimate/certificate_reverse.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace periost {
namespace {

constexpr int kLeastDepth = 5;
constexpr int kMostDepth = 14;
constexpr std::size_t kMaxTargets = 64;

using Target = ReverseScratch::Target;

Target make_target(Index id, const std::array<Vec3, 3>& c, double tolerance) {
  const Vec3 e1 = c[1] - c[0], e2 = c[2] - c[0], e0 = c[2] - c[1];
  const Vec3 n = cross(e1, e2);
  const double nn = squared_norm(n), length = std::sqrt(nn);
  const std::array<double, 3> squares{squared_norm(e0), squared_norm(e2), squared_norm(e1)};
  Target target{id, {}, {}, c, {e0, e2, e1}, squares, cross(e2, n) / nn, cross(n, e1) / nn, n / length, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    target.margin[k] = tolerance * std::sqrt(squares[k]) / length;
    target.lo[k] = std::min({c[0][k], c[1][k], c[2][k]}) - tolerance;
    target.hi[k] = std::max({c[0][k], c[1][k], c[2][k]}) + tolerance;
  }
  return target;
}

bool segment_is_within(Vec3 d, Vec3 edge, double squared_length, double limit) {
  const double along = std::clamp(dot(d, edge) / squared_length, 0.0, 1.0);
  return squared_norm(d - edge * along) <= limit;
}

// Whether p is within sqrt(limit) of the closed triangle.
bool is_within(const Target& target, Vec3 p, double limit) {
  if (p.x < target.lo.x || p.x > target.hi.x || p.y < target.lo.y || p.y > target.hi.y || p.z < target.lo.z ||
      p.z > target.hi.z) {
    return false;
  }
  const Vec3 d = p - target.corner[0];
  const double l1 = dot(d, target.row1), l2 = dot(d, target.row2), l0 = 1 - l1 - l2;
  if (l0 < -target.margin[0] || l1 < -target.margin[1] || l2 < -target.margin[2]) return false;
  const double h = dot(d, target.normal);
  if (h * h > limit) return false;
  if (l0 >= 0 && l1 >= 0 && l2 >= 0) return true;
  return (l1 < 0 && segment_is_within(d, target.edge[1], target.squared_length[1], limit)) ||
         (l2 < 0 && segment_is_within(d, target.edge[2], target.squared_length[2], limit)) ||
         (l0 < 0 && segment_is_within(p - target.corner[1], target.edge[0], target.squared_length[0], limit));
}

// The certificate of one proposal.
class Renewal {
 public:
  Renewal(const Reference& reference, double tolerance, ReverseScratch& scratch)
      : reference_(reference), limit_(tolerance * tolerance), scratch_(scratch) {}

  // Proves one isosurface triangle from the targets.
  bool renew(Index s, const CertifiedMesh& mesh, const Proposal& proposal, ReverseProof& proof) {
    const auto& c = reference_.triangles[s].corner;
    std::uint64_t common = ~std::uint64_t{0};
    for (const Index v : c) common &= ring_mask(v);
    if (common != 0) {
      proof = {scratch_.targets[static_cast<std::size_t>(std::countr_zero(common))].id,
               {kNoIndex, kNoIndex, kNoIndex}};
      return true;
    }
    std::array<std::uint64_t, 3> masks{};
    for (std::size_t k = 0; k < 3; ++k) {
      masks[k] = full_mask(c[k]);
      if (masks[k] == 0) return false;
    }
    std::uint64_t used = 0;
    depth_ = depth_for(reference_.corners(s));
    return cover(reference_.corners(s), masks, 0, used) && choose_home(used, mesh, proposal, proof);
  }

 private:
  std::uint64_t mask_of(Vec3 p, std::size_t begin, std::size_t end) const {
    std::uint64_t mask = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (is_within(scratch_.targets[i], p, limit_)) mask |= std::uint64_t{1} << i;
    }
    return mask;
  }

  std::uint64_t ring_mask(Index v) {
    if (scratch_.stamp[v] < scratch_.tick) {
      scratch_.stamp[v] = scratch_.tick;
      scratch_.mask[v] = mask_of(reference_.points[v], 0, scratch_.ring_size);
    }
    return scratch_.mask[v] & ring_bits();
  }

  std::uint64_t full_mask(Index v) {
    ring_mask(v);
    if (scratch_.stamp[v] == scratch_.tick) {
      ++scratch_.stamp[v];
      scratch_.mask[v] |= mask_of(reference_.points[v], scratch_.ring_size, scratch_.targets.size());
    }
    return scratch_.mask[v];
  }

  std::uint64_t ring_bits() const {
    return scratch_.ring_size >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << scratch_.ring_size) - 1;
  }

  // A piece over the border of two targets needs sides of about the tolerance to lie by one of them; two
  // bisections halve the sides.
  int depth_for(const std::array<Vec3, 3>& c) const {
    const double longest =
        std::max({squared_norm(c[1] - c[0]), squared_norm(c[2] - c[1]), squared_norm(c[0] - c[2])});
    return std::clamp(static_cast<int>(std::ceil(std::log2(longest / limit_))) + 1, kLeastDepth, kMostDepth);
  }

  // Bisects until each piece lies within the tolerance of one target; `used` collects these.
  bool cover(const std::array<Vec3, 3>& corner, const std::array<std::uint64_t, 3>& masks, int depth,
             std::uint64_t& used) const {
    const std::uint64_t common = masks[0] & masks[1] & masks[2];
    if (common != 0) {
      if ((common & used) == 0) used |= common & (~common + 1);
      return std::popcount(used) <= 4;
    }
    if (depth == depth_) return false;
    std::size_t longest = 0;
    double length = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double l = squared_norm(corner[(k + 2) % 3] - corner[(k + 1) % 3]);
      if (l > length) {
        length = l;
        longest = k;
      }
    }
    const std::size_t a = (longest + 1) % 3, b = (longest + 2) % 3;
    const Vec3 middle = (corner[a] + corner[b]) * 0.5;
    const std::uint64_t mask = mask_of(middle, 0, scratch_.targets.size());
    if (mask == 0) return false;
    for (const std::size_t replaced : {a, b}) {
      auto half = corner;
      auto half_masks = masks;
      half[replaced] = middle;
      half_masks[replaced] = mask;
      if (!cover(half, half_masks, depth + 1, used)) return false;
    }
    return true;
  }

  // Picks a home that shares a vertex with all others used.
  bool choose_home(std::uint64_t used, const CertifiedMesh& mesh, const Proposal& proposal,
                   ReverseProof& proof) const {
    for (std::uint64_t homes = used; homes != 0; homes &= homes - 1) {
      const int home = std::countr_zero(homes);
      const Index home_id = scratch_.targets[static_cast<std::size_t>(home)].id;
      const LinkedTriangle& cell = proposal.cell_of(mesh, home_id);
      proof = {home_id, {kNoIndex, kNoIndex, kNoIndex}};
      std::size_t count = 0;
      bool all_touch = true;
      for (std::uint64_t others = used & ~(std::uint64_t{1} << home); others != 0; others &= others - 1) {
        const Index id = scratch_.targets[static_cast<std::size_t>(std::countr_zero(others))].id;
        const LinkedTriangle& other = proposal.cell_of(mesh, id);
        all_touch = all_touch &&
                    (cell.has(other.corner[0]) || cell.has(other.corner[1]) || cell.has(other.corner[2]));
        proof.label[count++] = id;
      }
      if (all_touch) return true;
    }
    return false;
  }

  const Reference& reference_;
  double limit_;  // squared tolerance
  int depth_ = kLeastDepth;
  ReverseScratch& scratch_;
};

void collect_targets(const CertifiedMesh& mesh, const Proposal& proposal, const std::vector<Index>& around,
                     double tolerance, ReverseScratch& scratch) {
  scratch.targets.clear();
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    scratch.targets.push_back(
        make_target(proposal.after[i], corners_after(mesh, proposal, proposal.cells[i]), tolerance));
  }
  scratch.ring_size = scratch.targets.size();
  for (const Index t : around) {
    if (scratch.targets.size() == kMaxTargets) break;
    scratch.targets.push_back(make_target(t, corners_now(mesh, t), tolerance));
  }
}

// The isosurface triangles whose proofs the proposal may hurt.
void collect_hurt(const ReverseProofs& proofs, const Proposal& proposal, const std::vector<Index>& around,
                  std::vector<Index>& hurt) {
  hurt.clear();
  for (const Index t : proposal.before) {
    for (Index s = proofs.first[t]; s != kNoIndex; s = proofs.next[s]) hurt.push_back(s);
  }
  for (const Index t : around) {
    for (Index s = proofs.first[t]; s != kNoIndex; s = proofs.next[s]) {
      for (const Index label : proofs.proof[s].label) {
        if (label == kNoIndex) break;
        if (!proposal.before.contains(label)) continue;
        hurt.push_back(s);
        break;
      }
    }
  }
}

}  // namespace

ReverseProofs make_reverse_proofs(std::size_t triangle_count) {
  ReverseProofs proofs;
  proofs.proof.resize(triangle_count);
  proofs.next.assign(triangle_count, kNoIndex);
  proofs.first.resize(triangle_count);
  for (Index t = 0; t < triangle_count; ++t) proofs.proof[t].home = proofs.first[t] = t;
  return proofs;
}

bool certify_reverse(const Reference& reference, const CertifiedMesh& mesh, const ReverseProofs& proofs,
                     const Proposal& proposal, const std::vector<Index>& around, double tolerance,
                     ReverseScratch& scratch) {
  if (scratch.stamp.empty() || scratch.tick > 0xFFFFFFF0u) {
    scratch.stamp.assign(reference.points.size(), 0);
    scratch.mask.resize(reference.points.size());
    scratch.tick = 0;
  }
  scratch.tick += 2;
  collect_hurt(proofs, proposal, around, scratch.renewed);
  collect_targets(mesh, proposal, around, tolerance, scratch);
  scratch.proofs.resize(scratch.renewed.size());
  Renewal renewal(reference, tolerance, scratch);
  for (std::size_t i = 0; i < scratch.renewed.size(); ++i) {
    if (!renewal.renew(scratch.renewed[i], mesh, proposal, scratch.proofs[i])) return false;
  }
  return true;
}

void commit_reverse(const Proposal& proposal, const ReverseScratch& scratch, ReverseProofs& proofs) {
  const auto unlink = [&](Index s) {
    Index* link = &proofs.first[proofs.proof[s].home];
    while (*link != s) link = &proofs.next[*link];
    *link = proofs.next[s];
  };
  // The lists of the ring are emptied at once; those around it lose single entries.
  for (const Index s : scratch.renewed) {
    if (!proposal.before.contains(proofs.proof[s].home)) unlink(s);
  }
  for (const Index t : proposal.before) proofs.first[t] = kNoIndex;
  for (std::size_t i = 0; i < scratch.renewed.size(); ++i) {
    const Index s = scratch.renewed[i];
    proofs.proof[s] = scratch.proofs[i];
    proofs.next[s] = proofs.first[proofs.proof[s].home];
    proofs.first[proofs.proof[s].home] = s;
  }
}

}  // namespace periost
