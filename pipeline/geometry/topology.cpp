#include "pipeline/geometry/topology.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pipeline/base/error.h"
#include "pipeline/geometry/disjoint_sets.h"

namespace periost {
namespace {

struct Words {
  const char* one;
  const char* many;
};
constexpr std::array<Words, kViolationKinds> kNames{
    {{"boundary edge", "boundary edges"},
     {"edge of three or more triangles", "edges of three or more triangles"},
     {"pinched vertex", "pinched vertices"},
     {"misoriented edge", "misoriented edges"},
     {"degenerate triangle", "degenerate triangles"},
     {"point that is not finite", "points that are not finite"}}};

// Calls visit(begin, end) for each run of sides on the same edge.
template <class Visit>
void for_each_edge(const std::vector<EdgeUse>& uses, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    end = begin + 1;
    while (end < uses.size() && uses[end].a == uses[begin].a && uses[end].b == uses[begin].b) ++end;
    visit(begin, end);
  }
}

[[maybe_unused]] bool are_in_range(const std::vector<Triangle>& triangles, std::size_t points) {
  return std::all_of(triangles.begin(), triangles.end(),
                     [&](const Triangle& t) { return t[0] < points && t[1] < points && t[2] < points; });
}

// The sides whose smaller end is one of the points begin .. end - 1, sorted.
std::vector<EdgeUse> uses_from(const std::vector<Triangle>& triangles, std::size_t begin, std::size_t end) {
  PERIOST_ASSERT(triangles.size() < kNoIndex / 3);
  const auto for_sides = [&](auto&& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index p = triangles[t][k], q = triangles[t][(k + 1) % 3], lower = std::min(p, q);
        if (p == q || lower < begin || lower >= end) continue;
        visit(lower - begin, EdgeUse{lower, std::max(p, q), static_cast<Index>(3 * t + k), p < q});
      }
    }
  };
  // Counting sort by the smaller end, then a short sort inside each bucket of about three sides.
  std::vector<std::size_t> first(end - begin + 1, 0);
  for_sides([&](std::size_t bucket, const EdgeUse&) { ++first[bucket + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<EdgeUse> uses(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for_sides([&](std::size_t bucket, const EdgeUse& use) { uses[next[bucket]++] = use; });
  for (std::size_t bucket = 0; bucket < end - begin; ++bucket) {
    std::sort(
        uses.begin() + static_cast<std::ptrdiff_t>(first[bucket]),
        uses.begin() + static_cast<std::ptrdiff_t>(first[bucket + 1]),
        [](const EdgeUse& x, const EdgeUse& y) { return std::pair(x.b, x.side) < std::pair(y.b, y.side); });
  }
  return uses;
}

void unite_over_edges(const std::vector<EdgeUse>& uses, DisjointSets& sets) {
  for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin + 1; i < end; ++i) sets.unite(uses[begin].triangle(), uses[i].triangle());
  });
}

// Of elements: their sets, numbered by first appearance.
std::vector<std::uint32_t> numbered(DisjointSets& sets, std::size_t elements, std::uint32_t& count) {
  std::vector<std::uint32_t> number(elements);
  count = 0;
  for (Index t = 0; t < elements; ++t) {
    const Index root = sets.find(t);
    number[t] = root == t ? count++ : number[root];
  }
  return number;
}

std::vector<std::uint32_t> components_of(const std::vector<EdgeUse>& uses, std::size_t triangles,
                                         std::uint32_t& components) {
  DisjointSets sets(triangles);
  unite_over_edges(uses, sets);
  return numbered(sets, triangles, components);
}

class Examination {
 public:
  Examination(const SurfaceMesh& mesh, std::size_t places_per_kind)
      : mesh_(mesh), limit_(places_per_kind), uses_(sorted_edge_uses(mesh.triangles, mesh.points.size())) {}

  Topology run() {
    topology_.triangles = mesh_.triangles.size();
    find_bad_points();
    find_degenerate_triangles();
    find_bad_edges();
    find_pinched_vertices();
    components_of(uses_, mesh_.triangles.size(), topology_.components);
    topology_.euler = static_cast<std::int64_t>(topology_.vertices) -
                      static_cast<std::int64_t>(topology_.edges) +
                      static_cast<std::int64_t>(topology_.triangles);
    for (const auto& places : places_) {
      topology_.places.insert(topology_.places.end(), places.begin(), places.end());
    }
    return std::move(topology_);
  }

 private:
  void add(Violation kind, Index element, Vec3 place) {
    const auto k = static_cast<std::size_t>(kind);
    if (topology_.count[k]++ < limit_) places_[k].push_back({kind, element, place});
  }

  void find_bad_points() {
    for (Index p = 0; p < mesh_.points.size(); ++p) {
      if (!is_finite(mesh_.points[p])) add(Violation::kNonFinitePoint, p, mesh_.points[p]);
    }
  }

  void find_degenerate_triangles() {
    for (Index t = 0; t < mesh_.triangles.size(); ++t) {
      const auto [a, b, c] = mesh_.triangles[t];
      if (a != b && b != c && c != a) continue;
      add(Violation::kDegenerateTriangle, t, (mesh_.points[a] + mesh_.points[b] + mesh_.points[c]) / 3);
    }
  }

  void find_bad_edges() {
    for_each_edge(uses_, [&](std::size_t begin, std::size_t end) {
      ++topology_.edges;
      const EdgeUse& first = uses_[begin];
      const auto violation = [&](Violation kind) {
        add(kind, first.triangle(), 0.5 * (mesh_.points[first.a] + mesh_.points[first.b]));
      };
      if (end - begin == 1) violation(Violation::kBoundaryEdge);
      if (end - begin > 2) violation(Violation::kNonManifoldEdge);
      if (end - begin == 2 && first.forward == uses_[begin + 1].forward) {
        violation(Violation::kMisorientedEdge);
      }
    });
  }

  // Corners of a vertex are joined across the edges that end in it; each set of corners is a fan.
  void find_pinched_vertices() {
    DisjointSets corners(3 * mesh_.triangles.size());
    const auto corner_at = [&](const EdgeUse& use, Index vertex) {
      const bool at_start = (use.a == vertex) == use.forward;
      const Index t = use.triangle();
      return 3 * t + static_cast<Index>(at_start ? use.corner() : (use.corner() + 1) % 3);
    };
    for_each_edge(uses_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin + 1; i < end; ++i) {
        for (const Index vertex : {uses_[begin].a, uses_[begin].b}) {
          corners.unite(corner_at(uses_[begin], vertex), corner_at(uses_[i], vertex));
        }
      }
    });
    std::vector<std::uint32_t> fans(mesh_.points.size(), 0);
    for (Index corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      if (corners.find(corner) == corner) ++fans[mesh_.triangles[corner / 3][corner % 3]];
    }
    for (Index p = 0; p < fans.size(); ++p) {
      if (fans[p] > 0) ++topology_.vertices;
      if (fans[p] > 1) add(Violation::kPinchedVertex, p, mesh_.points[p]);
    }
    topology_.unused_points = mesh_.points.size() - topology_.vertices;
  }

  const SurfaceMesh& mesh_;
  std::size_t limit_;
  std::vector<EdgeUse> uses_;
  std::array<std::vector<ViolationPlace>, kViolationKinds> places_;
  Topology topology_;
};

}  // namespace

std::string name_of(Violation kind) {
  return kNames[static_cast<std::size_t>(kind)].one;
}

std::vector<EdgeUse> sorted_edge_uses(const std::vector<Triangle>& triangles, std::size_t points) {
  PERIOST_ASSERT(are_in_range(triangles, points));
  return uses_from(triangles, 0, points);
}

std::vector<std::array<Index, 3>> triangle_neighbours(const std::vector<Triangle>& triangles,
                                                      std::size_t points) {
  const std::vector<EdgeUse> uses = sorted_edge_uses(triangles, points);
  std::vector<std::array<Index, 3>> neighbours(triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
  for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
    if (end - begin != 2) return;
    const EdgeUse &x = uses[begin], &y = uses[begin + 1];
    // The side from corner k to k + 1 is opposite to corner k + 2.
    neighbours[x.triangle()][static_cast<std::size_t>((x.corner() + 2) % 3)] = y.triangle();
    neighbours[y.triangle()][static_cast<std::size_t>((y.corner() + 2) % 3)] = x.triangle();
  });
  return neighbours;
}

std::vector<std::uint32_t> triangle_components(const std::vector<Triangle>& triangles, std::size_t points) {
  constexpr std::size_t kPointsAtOnce = 65'536;  // all sides at once take four times the triangles' memory
  PERIOST_ASSERT(are_in_range(triangles, points));
  DisjointSets sets(triangles.size());
  for (std::size_t begin = 0; begin < points; begin += kPointsAtOnce)
    unite_over_edges(uses_from(triangles, begin, std::min(points, begin + kPointsAtOnce)), sets);
  std::uint32_t components = 0;
  return numbered(sets, triangles.size(), components);
}

std::vector<std::uint8_t> in_small_component(const std::vector<Triangle>& triangles, std::size_t points,
                                             std::size_t least) {
  const auto component = triangle_components(triangles, points);
  std::vector<std::size_t> size;
  for (const std::uint32_t c : component) {
    size.resize(std::max<std::size_t>(size.size(), c + std::size_t{1}));
    ++size[c];
  }
  std::vector<std::uint8_t> is_small;
  is_small.reserve(component.size());
  for (const std::uint32_t c : component) is_small.push_back(size[c] < least ? 1 : 0);
  return is_small;
}

SurfaceMesh without_small_components(const SurfaceMesh& surface, std::size_t least) {
  const auto is_small = in_small_component(surface.triangles, surface.points.size(), least);
  SurfaceMesh kept;
  kept.voxel_mm = surface.voxel_mm;
  kept.was_read = surface.was_read;
  std::vector<Index> number(surface.points.size(), kNoIndex);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (is_small[t]) continue;
    Triangle triangle = surface.triangles[t];
    for (Index& v : triangle) {
      if (number[v] == kNoIndex) {
        number[v] = static_cast<Index>(kept.points.size());
        kept.points.push_back(surface.points[v]);
      }
      v = number[v];
    }
    kept.triangles.push_back(triangle);
  }
  return kept;
}

std::vector<std::uint32_t> point_valences(const std::vector<Triangle>& triangles, std::size_t points) {
  const std::vector<EdgeUse> uses = sorted_edge_uses(triangles, points);
  std::vector<std::uint32_t> valence(points, 0);
  for_each_edge(uses, [&](std::size_t begin, std::size_t) {
    ++valence[uses[begin].a];
    ++valence[uses[begin].b];
  });
  return valence;
}

Topology examine_topology(const SurfaceMesh& mesh, std::size_t places_per_kind) {
  return Examination(mesh, places_per_kind).run();
}

std::string describe_violations(const Topology& topology) {
  std::string text;
  for (std::size_t k = 0; k < kViolationKinds; ++k) {
    if (topology.count[k] == 0) continue;
    if (!text.empty()) text += "; ";
    text += fmt::format("{} {}", topology.count[k], topology.count[k] == 1 ? kNames[k].one : kNames[k].many);
    const auto place =
        std::find_if(topology.places.begin(), topology.places.end(),
                     [&](const ViolationPlace& p) { return p.kind == static_cast<Violation>(k); });
    if (place == topology.places.end()) continue;
    text += fmt::format(", {}at ({:.3f}, {:.3f}, {:.3f}) mm", topology.count[k] == 1 ? "" : "the first ",
                        place->place_mm.x, place->place_mm.y, place->place_mm.z);
  }
  return text;
}

std::string violation_code(const Topology& topology) {
  constexpr std::pair<Violation, const char*> kCodes[] = {
      {Violation::kNonFinitePoint, "surface.not_finite"},
      {Violation::kDegenerateTriangle, "surface.degenerate"},
      {Violation::kBoundaryEdge, "surface.open"},
      {Violation::kNonManifoldEdge, "surface.not_manifold"},
      {Violation::kPinchedVertex, "surface.not_manifold"},
      {Violation::kMisorientedEdge, "surface.misoriented"}};
  for (const auto& [kind, code] : kCodes) {
    if (topology.violations(kind) > 0) return code;
  }
  return {};
}

double signed_volume(const SurfaceMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // About a point of the surface, since a far origin would cost digits.
  const Vec3 origin = mesh.points[mesh.triangles[0][0]];
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six_volumes += dot(mesh.points[a] - origin, cross(mesh.points[b] - origin, mesh.points[c] - origin));
  }
  return six_volumes / 6;
}

double surface_area(const SurfaceMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area += norm(area_vector(mesh.points[a], mesh.points[b], mesh.points[c]));
  }
  return area;
}

}  // namespace periost
