#include "stages/decimate/certified_guard.h"

#include <algorithm>
#include <cstdlib>

namespace periost {
namespace {

constexpr int kFewest = 3, kMost = 12;  // valences of what lies across an edge, as marching cubes makes them
constexpr double kSlack = 1e-9;         // sums of deficits that differ by rounding count as equal

// The mesh before a proposal, in the form that the sums of deficits are taken over.
struct BeforeView {
  const CertifiedMesh& mesh;
  const LinkedTriangle& cell(Index t) const { return mesh.triangles[t]; }
  // The triangle across the edge opposite to corner k.
  const LinkedTriangle& beside(const LinkedTriangle& cell, std::size_t k) const {
    return mesh.triangles[cell.across[k]];
  }
  Vec3 point(Index v) const { return mesh.points[v]; }
  int valence(Index v) const { return mesh.valence[v]; }
};

// The mesh as it would be after it.
struct AfterView {
  const CertifiedMesh& mesh;
  const Proposal& proposal;
  const LinkedTriangle& cell(Index t) const { return proposal.cell_of(mesh, t); }
  // A triangle outside the ring still names the one that lay across its edge before: the new one is found by
  // the edge.
  const LinkedTriangle& beside(const LinkedTriangle& cell, std::size_t k) const {
    if (!proposal.before.contains(cell.across[k])) return mesh.triangles[cell.across[k]];
    const auto has = [](const LinkedTriangle& t, Index v) {
      return t.corner[0] == v || t.corner[1] == v || t.corner[2] == v;
    };
    for (const LinkedTriangle& other : proposal.cells) {
      if (&other != &cell && has(other, cell.corner[(k + 1) % 3]) && has(other, cell.corner[(k + 2) % 3])) {
        return other;
      }
    }
    return proposal.cell_of(mesh, cell.across[k]);
  }
  Vec3 point(Index v) const { return proposal.point_of(mesh, v); }
  int valence(Index v) const { return proposal.valence_of(mesh, v); }
};

template <class View>
std::array<Vec3, 3> corners_of(const View& view, const LinkedTriangle& t) {
  return {view.point(t.corner[0]), view.point(t.corner[1]), view.point(t.corner[2])};
}

Vec3 normal_of(const std::array<Vec3, 3>& c) {
  return normalized(cross(c[1] - c[0], c[2] - c[0]));
}

// Twice the cosine of the smallest angle, which faces the shortest edge, as a sum over the root of a product.
struct CosineTerms {
  double sum, product;
};
CosineTerms cosine_terms(const std::array<Vec3, 3>& c) {
  const double a = squared_norm(c[2] - c[1]), b = squared_norm(c[0] - c[2]), d = squared_norm(c[1] - c[0]);
  // The shortest and the two others, without branches: which it is can hardly be foreseen.
  const double less = std::min(a, b), other = std::max(a, b);
  const double shortest = std::min(less, d), another = std::max(less, d);
  return {other + another - shortest, other * another};
}

// How far the smallest angle falls short of the limit, measured by twice its cosine: in radians at 30
// degrees.
double angle_deficit(const std::array<Vec3, 3>& c, double twice_limit_cosine) {
  const auto [sum, product] = cosine_terms(c);
  // Most have none: no root is needed to see that.
  if (sum <= 0 || sum * sum <= twice_limit_cosine * twice_limit_cosine * product) return 0;
  return std::max(0.0, (product > 0 ? sum / std::sqrt(product) : 2) - twice_limit_cosine);
}

// What deficits of angles count.
class DeficitScale {
 public:
  explicit DeficitScale(const GuardLimits& limits)
      : twice_cosine_(2 * std::cos(limits.min_angle)),
        below_floor_(limits.floor_angle > 0 ? 2 * std::cos(limits.floor_angle) - twice_cosine_ : 2),
        is_worst_first_(limits.worst_angle_first) {}

  void add(const std::array<Vec3, 3>& corners, AngleDeficits& deficits) const {
    const double deficit = angle_deficit(corners, twice_cosine_);
    deficits.sum += is_worst_first_ ? deficit * deficit * deficit * deficit : deficit;
    deficits.under_floor += std::max(0.0, deficit - below_floor_);
  }

 private:
  double twice_cosine_;
  double below_floor_;  // deficits above this are under the floor, too
  bool is_worst_first_;
};

// Sum over the half-edges of one triangle of the excess of |D| over the limit.
template <class View>
int topology_deficit(const View& view, const LinkedTriangle& cell, int limit) {
  const std::array<int, 3> valence{view.valence(cell.corner[0]), view.valence(cell.corner[1]),
                                   view.valence(cell.corner[2])};
  int sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (cell.across[k] == kNoIndex) continue;
    const Index u = cell.corner[(k + 1) % 3], v = cell.corner[(k + 2) % 3];
    const int known = valence[(k + 1) % 3] + valence[(k + 2) % 3] - valence[k];
    // Most edges meet the limit whatever lies across them.
    if (known - kFewest <= limit && kMost - known <= limit) continue;
    const LinkedTriangle& other = view.beside(cell, k);
    const Index opposite = other.corner[3 - other.slot_of(u) - other.slot_of(v)];
    sum += std::max(0, std::abs(known - view.valence(opposite)) - limit);
  }
  return sum;
}

double barycentric_deficit(Vec3 centre, const std::array<Vec3, 3>& neighbours, double limit) {
  return std::max(0.0, limit - smallest_barycentric(centre, neighbours[0], neighbours[1], neighbours[2]));
}

double barycentric_deficit_before(const CertifiedMesh& mesh, Index t, double limit) {
  std::array<Vec3, 3> neighbours;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index across = mesh.triangles[t].across[k];
    if (across == kNoIndex) return 0;
    neighbours[k] = barycentre(mesh, across);
  }
  return barycentric_deficit(barycentre(mesh, t), neighbours, limit);
}

// The simplex vertices that a proposal moves, at the barycentres of the new triangles, and those beside them.
class NewCentres {
 public:
  NewCentres(const CertifiedMesh& mesh, const Proposal& proposal) : mesh_(mesh), proposal_(proposal) {
    for (const LinkedTriangle& cell : proposal.cells) {
      const auto c = corners_after(mesh, proposal, cell);
      centre_.push_back((c[0] + c[1] + c[2]) / 3);
    }
    for (std::size_t i = 0; i < proposal.cells.size(); ++i) {
      for (const Index t : proposal.cells[i].across) {
        if (t == kNoIndex || rim_.is_full() || position(t, i) < proposal.after.size()) continue;
        rim_.push_back(t);
        beside_rim_.push_back(i);
      }
    }
  }

  // The triangles around the ring, one that lies at two of its edges twice.
  const FixedList<Index, kMaxRing>& rim() const { return rim_; }
  bool is_repeated(std::size_t r) const {
    return std::find(rim_.begin(), rim_.begin() + r, rim_[r]) != rim_.begin() + r;
  }

  double deficit_inside(std::size_t i, double limit) const {
    std::array<Vec3, 3> neighbours;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index across = proposal_.cells[i].across[k];
      if (across == kNoIndex) return 0;
      const std::size_t at = position(across, i);
      neighbours[k] = at < proposal_.after.size() ? centre_[at] : barycentre(mesh_, across);
    }
    return barycentric_deficit(centre_[i], neighbours, limit);
  }

  double deficit_at_rim(std::size_t r, double limit) const {
    const LinkedTriangle& t = mesh_.triangles[rim_[r]];
    std::array<Vec3, 3> neighbours;
    for (std::size_t k = 0; k < 3; ++k) {
      if (t.across[k] == kNoIndex) return 0;
      neighbours[k] =
          proposal_.before.contains(t.across[k]) ? centre_[beside_rim(r, k)] : barycentre(mesh_, t.across[k]);
    }
    return barycentric_deficit(barycentre(mesh_, rim_[r]), neighbours, limit);
  }

 private:
  // Where a triangle stands among the new ones, as many as there are if it is none; in a ring, beside the
  // i-th.
  std::size_t position(Index t, std::size_t i) const {
    const auto& after = proposal_.after;
    const std::size_t next = i + 1 < after.size() ? i + 1 : 0, last = i > 0 ? i - 1 : after.size() - 1;
    if (after[next] == t) return next;
    if (after[last] == t) return last;
    return static_cast<std::size_t>(std::find(after.begin(), after.end(), t) - after.begin());
  }

  // The new triangle across an edge of one around the ring.
  std::size_t beside_rim(std::size_t r, std::size_t k) const {
    const LinkedTriangle& t = mesh_.triangles[rim_[r]];
    for (std::size_t other = 0; other < rim_.size(); ++other) {
      const LinkedTriangle& cell = proposal_.cells[beside_rim_[other]];
      if (rim_[other] == rim_[r] && cell.has(t.corner[(k + 1) % 3]) && cell.has(t.corner[(k + 2) % 3])) {
        return beside_rim_[other];
      }
    }
    return beside_rim_[r];
  }

  const CertifiedMesh& mesh_;
  const Proposal& proposal_;
  FixedList<Vec3, kMaxRing> centre_;
  FixedList<Index, kMaxRing> rim_;
  FixedList<std::size_t, kMaxRing> beside_rim_;  // of rim_: the new triangle that it lies beside
};

// Excess of the dihedral over its limit at half-edges: where the body is sharp, and where the space around it
// is. Apart, so that a narrow gap outside cannot be traded for a sharp edge inside.
struct DihedralDeficits {
  double inside = 0, outside = 0;

  double all() const { return inside + outside; }
};

// Adds what one half-edge has, between triangles with these corners and normals.
void add_dihedral_deficit(const std::array<Vec3, 3>& corners, Vec3 normal, const std::array<Vec3, 3>& others,
                          Vec3 other_normal, double limit, DihedralDeficits& sum) {
  const double deficit = limit - dot(normal, other_normal);
  if (!(deficit > 0)) return;
  const bool lies_below = dot(normal, others[0] + others[1] + others[2] - corners[0] * 3) < 0;
  (lies_below ? sum.inside : sum.outside) += deficit;
}

DihedralDeficits dihedral_deficits_before(const CertifiedMesh& mesh, const Proposal& proposal, double limit) {
  DihedralDeficits sum;
  for (const Index t : proposal.before) {
    const auto corners = corners_now(mesh, t);
    const Vec3 normal = normal_of(corners);
    for (const Index across : mesh.triangles[t].across) {
      if (across == kNoIndex) continue;
      const auto others = corners_now(mesh, across);
      add_dihedral_deficit(corners, normal, others, normal_of(others), limit, sum);
    }
  }
  return sum;
}

// The new triangles, each with its corners and normal.
struct NewTriangles {
  FixedList<std::array<Vec3, 3>, kMaxRing> corners;
  FixedList<Vec3, kMaxRing> normals;

  NewTriangles(const CertifiedMesh& mesh, const Proposal& proposal) {
    for (const LinkedTriangle& cell : proposal.cells) {
      corners.push_back(corners_after(mesh, proposal, cell));
      normals.push_back(normal_of(corners[corners.size() - 1]));
    }
  }
};

DihedralDeficits dihedral_deficits_after(const CertifiedMesh& mesh, const Proposal& proposal,
                                         const NewTriangles& fresh, double limit) {
  DihedralDeficits sum;
  for (std::size_t i = 0; i < proposal.cells.size(); ++i) {
    for (const Index across : proposal.cells[i].across) {
      if (across == kNoIndex) continue;
      const auto at = static_cast<std::size_t>(
          std::find(proposal.after.begin(), proposal.after.end(), across) - proposal.after.begin());
      const bool is_new = at < proposal.after.size();
      const auto others = is_new ? fresh.corners[at] : corners_now(mesh, across);
      add_dihedral_deficit(fresh.corners[i], fresh.normals[i], others,
                           is_new ? fresh.normals[at] : normal_of(others), limit, sum);
    }
  }
  return sum;
}

// Triangles that are not in the ring but whose edges' criteria change with the valences.
void collect_valence_neighbours(const CertifiedMesh& mesh, const Proposal& proposal,
                                FixedList<Index, 4 * kMaxStar>& found) {
  Star star;
  for (const auto& change : proposal.valence_changes) {
    if (change.vertex == proposal.moved || !gather_ring(mesh, change.vertex, star)) continue;
    for (const Index t : star.triangle) {
      if (!proposal.before.contains(t) && !found.contains(t)) found.push_back(t);
    }
  }
}

}  // namespace

double twice_largest_cosine(const std::array<Vec3, 3>& c) {
  const auto [sum, product] = cosine_terms(c);
  return product > 0 ? sum / std::sqrt(product) : 2;
}

bool has_angle_under(const std::array<Vec3, 3>& triangle, double limit) {
  return twice_largest_cosine(triangle) > 2 * std::cos(limit);
}

double min_angle(const std::array<Vec3, 3>& triangle) {
  return std::acos(std::clamp(twice_largest_cosine(triangle) / 2, 0.0, 1.0));
}

double smallest_barycentric(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 e1 = b - a, e2 = c - a, d = p - a;
  const Vec3 n = cross(e1, e2);
  const double nn = squared_norm(n);
  if (!(nn > 0)) return 0;
  const double u = dot(cross(d, e2), n) / nn, v = dot(cross(e1, d), n) / nn;
  return std::min({u, v, 1 - u - v});
}

bool meets_topology(const CertifiedMesh& mesh, const Proposal& proposal, const GuardLimits& limits,
                    bool only_valences) {
  if (proposal.valence_changes.size() == 0) return true;
  const BeforeView before{mesh};
  const AfterView after{mesh, proposal};
  int old_excess = 0, new_excess = 0;
  const auto excess = [&](int valence) {
    return std::max({0, valence - limits.max_valence, limits.min_valence - valence});
  };
  for (const auto& change : proposal.valence_changes) {
    old_excess += excess(before.valence(change.vertex));
    new_excess += excess(after.valence(change.vertex));
  }
  if (new_excess > old_excess || only_valences) return new_excess <= old_excess;
  FixedList<Index, 4 * kMaxStar> neighbours;
  collect_valence_neighbours(mesh, proposal, neighbours);
  int new_sum = 0;
  const auto sum = [&](const auto& view, const auto& triangles) {
    int deficit = 0;
    for (const Index t : triangles) deficit += topology_deficit(view, mesh.triangles[t], limits.topology);
    return deficit;
  };
  for (const LinkedTriangle& cell : proposal.cells) new_sum += topology_deficit(after, cell, limits.topology);
  new_sum += sum(after, neighbours);
  if (new_sum == 0) return true;
  return new_sum <= sum(before, proposal.before) + sum(before, neighbours);
}

bool meets_angles(const CertifiedMesh& mesh, Proposal& proposal, const GuardLimits& limits, double* gain) {
  const DeficitScale scale(limits);
  if (!proposal.deficits_before) {
    AngleDeficits& before = proposal.deficits_before.emplace();
    for (const Index t : proposal.before) scale.add(corners_now(mesh, t), before);
  }
  const AngleDeficits& before = *proposal.deficits_before;
  const double most = before.sum * (1 + limits.growth);
  AngleDeficits after;
  for (const LinkedTriangle& cell : proposal.cells) {
    scale.add(corners_after(mesh, proposal, cell), after);
    if (after.sum > most || after.under_floor > before.under_floor) return false;
  }
  if (gain) *gain = before.sum - after.sum;
  return true;
}

bool meets_fold(const Reference& reference, const CertifiedMesh& mesh, const Proposal& proposal,
                const GuardLimits& limits) {
  const NewTriangles fresh(mesh, proposal);
  for (std::size_t i = 0; i < proposal.after.size(); ++i) {
    const Vec3 n = fresh.normals[i];
    Vec3 mean;
    for (const Index v : proposal.cells[i].corner) mean += reference.normals[proposal.nearest_of(mesh, v)];
    if (dot(n, normalized(mean)) > limits.fold_cosine) continue;
    const Index id = proposal.before.contains(proposal.after[i]) ? proposal.after[i] : proposal.before[0];
    const Vec3 old = normal_of(corners_now(mesh, id));
    if (dot(n, old) <= limits.fold_cosine) return false;
  }
  const DihedralDeficits new_sum = dihedral_deficits_after(mesh, proposal, fresh, limits.dihedral_cosine);
  if (!(new_sum.all() > 0)) return true;
  const DihedralDeficits old_sum = dihedral_deficits_before(mesh, proposal, limits.dihedral_cosine);
  return new_sum.inside <= old_sum.inside + kSlack && new_sum.all() <= old_sum.all() + kSlack;
}

bool meets_barycentric(const CertifiedMesh& mesh, const Proposal& proposal, const GuardLimits& limits) {
  const NewCentres fresh(mesh, proposal);
  const double limit = limits.min_barycentric;
  double old_sum = 0, new_sum = 0;
  for (std::size_t i = 0; i < proposal.cells.size(); ++i) new_sum += fresh.deficit_inside(i, limit);
  for (std::size_t r = 0; r < fresh.rim().size(); ++r) {
    if (!fresh.is_repeated(r)) new_sum += fresh.deficit_at_rim(r, limit);
  }
  if (new_sum == 0) return true;
  for (const Index t : proposal.before) old_sum += barycentric_deficit_before(mesh, t, limit);
  for (std::size_t r = 0; r < fresh.rim().size(); ++r) {
    if (!fresh.is_repeated(r)) old_sum += barycentric_deficit_before(mesh, fresh.rim()[r], limit);
  }
  return new_sum <= old_sum + kSlack;
}

}  // namespace periost
