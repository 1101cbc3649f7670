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
  const double inverse = 1 / squared_norm(n);
  const std::array<double, 3> squares{squared_norm(e0), squared_norm(e2), squared_norm(e1)};
  Target target{
      id, c, {e0, e2, e1}, squares, cross(e2, n) * inverse, cross(n, e1) * inverse, n * std::sqrt(inverse),
      {}};
  for (std::size_t k = 0; k < 3; ++k) {
    target.margin[k] = tolerance * std::sqrt(squares[k] * inverse);
  }
  return target;
}

bool segment_is_within(Vec3 d, Vec3 edge, double squared_length, double limit) {
  const double along = std::clamp(dot(d, edge) / squared_length, 0.0, 1.0);
  return squared_norm(d - edge * along) <= limit;
}

// Whether p is within sqrt(limit) of the closed triangle.
bool is_within(const Target& target, Vec3 p, double limit) {
  const Vec3 d = p - target.corner[0];
  const double l1 = dot(d, target.row1), l2 = dot(d, target.row2), l0 = 1 - l1 - l2;
  const double h = dot(d, target.normal);
  // One branch instead of several that are hard to foresee.
  const int is_far = static_cast<int>(l0 < -target.margin[0]) | static_cast<int>(l1 < -target.margin[1]) |
                     static_cast<int>(l2 < -target.margin[2]) | static_cast<int>(h * h > limit);
  if (is_far != 0) return false;
  if (l0 >= 0 && l1 >= 0 && l2 >= 0) return true;
  return (l1 < 0 && segment_is_within(d, target.edge[1], target.squared_length[1], limit)) ||
         (l2 < 0 && segment_is_within(d, target.edge[2], target.squared_length[2], limit)) ||
         (l0 < 0 && segment_is_within(p - target.corner[1], target.edge[0], target.squared_length[0], limit));
}

// The certificate of one proposal.
class Renewal {
 public:
  Renewal(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal,
          const std::vector<Index>& around, const RingScratch* ring, double tolerance,
          ReverseScratch& scratch)
      : reference_(reference),
        mesh_(mesh),
        proposal_(proposal),
        around_(around),
        ring_(ring),
        tolerance_(tolerance),
        limit_(tolerance * tolerance),
        scratch_(scratch),
        count_(std::min(kMaxTargets, proposal.after.size() + around.size())) {
    scratch_.targets.resize(kMaxTargets);
    scratch_.made = 0;
  }

  // Proves one isosurface triangle anew: by the overlay, by one triangle that it lies over, by these and what
  // proved it before, by all that is near.
  bool renew(Index s, const ReverseProof& before, ReverseProof& proof) {
    if (ring_ && is_covered_by_ring(proposal_, *ring_, s, proof)) return true;
    std::uint64_t likely = cells_under(s);
    if (prove_by_one(s, likely, proof)) return true;
    for (const Index id : {before.home, before.label[0], before.label[1], before.label[2]}) {
      likely |= bit_of_around(id);
    }
    return prove(s, likely, kLeastDepth, proof) ||
           prove(s, bits_up_to(count_), depth_for(reference_.corners(s)), proof);
  }

 private:
  static std::uint64_t bits_up_to(std::size_t count) {
    return count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
  }

  // The new triangles that s lies over as far as is known; all when it is not.
  std::uint64_t cells_under(Index s) const {
    const RingScratch::Visit* const visit = ring_ ? ring_->find_visit(s) : nullptr;
    if (visit && visit->cells != 0) return visit->cells;
    return bits_up_to(std::min(count_, proposal_.after.size()));
  }

  std::uint64_t bit_of_around(Index id) const {
    const std::size_t ring_size = proposal_.after.size();
    for (std::size_t i = 0; ring_size + i < count_; ++i) {
      if (around_[i] == id) return std::uint64_t{1} << (ring_size + i);
    }
    return 0;
  }

  const Target& target(std::size_t i) {
    if ((scratch_.made >> i & 1u) == 0) {
      scratch_.made |= std::uint64_t{1} << i;
      const std::size_t ring_size = proposal_.after.size();
      scratch_.targets[i] =
          i < ring_size
              ? make_target(proposal_.after[i], corners_after(mesh_, proposal_, proposal_.cells[i]),
                            tolerance_)
              : make_target(around_[i - ring_size], corners_now(mesh_, around_[i - ring_size]), tolerance_);
    }
    return scratch_.targets[i];
  }

  std::uint64_t mask_of(Vec3 p, std::uint64_t wanted) {
    std::uint64_t mask = 0;
    for (std::uint64_t left = wanted; left != 0; left &= left - 1) {
      if (is_within(target(static_cast<std::size_t>(std::countr_zero(left))), p, limit_)) {
        mask |= left & (~left + 1);
      }
    }
    return mask;
  }

  // Those of the wanted targets that an isosurface vertex is within the tolerance of.
  std::uint64_t vertex_mask(Index v, std::uint64_t wanted) {
    if (scratch_.stamp[v] != scratch_.tick) {
      scratch_.stamp[v] = scratch_.tick;
      scratch_.known[v] = scratch_.mask[v] = 0;
      if (const RingScratch::Foot* const foot = ring_ ? ring_->find_foot(v) : nullptr) {
        if (!foot->is_high) scratch_.known[v] = scratch_.mask[v] = foot->cell;
      }
    }
    const std::uint64_t missing = wanted & ~scratch_.known[v];
    if (missing != 0) {
      scratch_.mask[v] |= mask_of(reference_.points[v], missing);
      scratch_.known[v] |= missing;
    }
    return scratch_.mask[v] & wanted;
  }

  bool prove_by_one(Index s, std::uint64_t wanted, ReverseProof& proof) {
    for (const Index v : reference_.triangles[s].corner) {
      wanted = vertex_mask(v, wanted);
      if (wanted == 0) return false;
    }
    proof = {target(static_cast<std::size_t>(std::countr_zero(wanted))).id, {kNoIndex, kNoIndex, kNoIndex}};
    return true;
  }

  bool prove(Index s, std::uint64_t wanted, int depth, ReverseProof& proof) {
    std::array<std::uint64_t, 3> masks{};
    for (std::size_t k = 0; k < 3; ++k) {
      masks[k] = vertex_mask(reference_.triangles[s].corner[k], wanted);
      if (masks[k] == 0) return false;
    }
    std::uint64_t used = 0;
    depth_ = depth;
    wanted_ = wanted;
    return cover(reference_.corners(s), masks, 0, used) && choose_home(used, proof);
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
             std::uint64_t& used) {
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
    const std::uint64_t mask = mask_of(middle, wanted_);
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
  bool choose_home(std::uint64_t used, ReverseProof& proof) const {
    for (std::uint64_t homes = used; homes != 0; homes &= homes - 1) {
      const int home = std::countr_zero(homes);
      const Index home_id = scratch_.targets[static_cast<std::size_t>(home)].id;
      const LinkedTriangle& cell = proposal_.cell_of(mesh_, home_id);
      proof = {home_id, {kNoIndex, kNoIndex, kNoIndex}};
      std::size_t count = 0;
      bool all_touch = true;
      for (std::uint64_t others = used & ~(std::uint64_t{1} << home); others != 0; others &= others - 1) {
        const Index id = scratch_.targets[static_cast<std::size_t>(std::countr_zero(others))].id;
        const LinkedTriangle& other = proposal_.cell_of(mesh_, id);
        all_touch = all_touch &&
                    (cell.has(other.corner[0]) || cell.has(other.corner[1]) || cell.has(other.corner[2]));
        proof.label[count++] = id;
      }
      if (all_touch) return true;
    }
    return false;
  }

  const Reference& reference_;
  const CertifiedMesh& mesh_;
  const Proposal& proposal_;
  const std::vector<Index>& around_;
  const RingScratch* ring_;
  double tolerance_, limit_;  // limit_: its square
  ReverseScratch& scratch_;
  std::size_t count_;  // of targets
  int depth_ = kLeastDepth;
  std::uint64_t wanted_ = 0;
};

// The isosurface triangles whose proofs the proposal may hurt.
void collect_hurt(const ReverseProofs& proofs, const Proposal& proposal, const std::vector<Index>& around,
                  std::vector<Index>& hurt) {
  hurt.clear();
  for (const Index t : proposal.before) {
    proofs.for_homed(t, [&](Index s) { hurt.push_back(s); });
  }
  for (const Index t : around) {
    for (Index s = proofs.first_labelled[t]; s != kNoIndex; s = proofs.next[s]) {
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
  proofs.first_labelled.assign(triangle_count, kNoIndex);
  for (Index t = 0; t < triangle_count; ++t) proofs.proof[t].home = proofs.first[t] = t;
  return proofs;
}

bool certify_reverse(const Reference& reference, const CertifiedMesh& mesh, const ReverseProofs& proofs,
                     const Proposal& proposal, const std::vector<Index>& around, const RingScratch* ring,
                     double tolerance, ReverseScratch& scratch) {
  if (scratch.stamp.empty() || ++scratch.tick == 0) {
    scratch.stamp.assign(reference.points.size(), 0);
    scratch.known.resize(reference.points.size());
    scratch.mask.resize(reference.points.size());
    scratch.tick = 1;
  }
  collect_hurt(proofs, proposal, around, scratch.renewed);
  scratch.proofs.resize(scratch.renewed.size());
  Renewal renewal(reference, mesh, proposal, around, ring, tolerance, scratch);
  for (std::size_t i = 0; i < scratch.renewed.size(); ++i) {
    const Index s = scratch.renewed[i];
    if (!renewal.renew(s, proofs.proof[s], scratch.proofs[i])) return false;
  }
  return true;
}

void commit_reverse(const Proposal& proposal, const ReverseScratch& scratch, ReverseProofs& proofs) {
  const auto list_of = [&](Index s) -> Index& {
    const ReverseProof& proof = proofs.proof[s];
    return proof.label[0] == kNoIndex ? proofs.first[proof.home] : proofs.first_labelled[proof.home];
  };
  // The lists of the ring are emptied at once; those around it lose single entries.
  for (const Index s : scratch.renewed) {
    if (proposal.before.contains(proofs.proof[s].home)) continue;
    Index* link = &list_of(s);
    while (*link != s) link = &proofs.next[*link];
    *link = proofs.next[s];
  }
  for (const Index t : proposal.before) proofs.first[t] = proofs.first_labelled[t] = kNoIndex;
  for (std::size_t i = 0; i < scratch.renewed.size(); ++i) {
    const Index s = scratch.renewed[i];
    proofs.proof[s] = scratch.proofs[i];
    Index& first = list_of(s);
    proofs.next[s] = first;
    first = s;
  }
}

}  // namespace periost
