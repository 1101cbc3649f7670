#include "stages/tetgen/sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/base/error.h"
#include "pipeline/geometry/closest_point.h"

namespace periost {
namespace {

using periost_tetgen::SizeGrid;

constexpr double kMostNodes = 2e6;
constexpr float kNoWish = std::numeric_limits<float>::infinity();

struct Box {
  Vec3 low, high;
};

Box box_of(const SurfaceMesh& surface) {
  Box box{surface.points[0], surface.points[0]};
  for (const Vec3& p : surface.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], p[k]);
      box.high[k] = std::max(box.high[k], p[k]);
    }
  }
  return box;
}

// Tetrahedra that stand well on triangles of edge 1 have edges up to this.
constexpr double kAboveTriangles = 1.4;

double longest_edge(const SurfaceMesh& surface, const Triangle& t) {
  const Vec3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
  return std::max({distance(a, b), distance(b, c), distance(c, a)});
}

// The smallest edge that anything asks for; the field's is its smallest value above 0.
double smallest_wish(const SurfaceMesh& surface, const SizeOptions& sizes, double voxel_mm,
                     const Image* field) {
  double smallest = distance(box_of(surface).low, box_of(surface).high);
  const auto consider = [&smallest](double size) {
    if (size > 0) smallest = std::min(smallest, size);
  };
  consider(sizes.inside.in_mm(voxel_mm));
  if (sizes.near_surface.value > 0) {
    consider(sizes.near_surface.in_mm(voxel_mm));
  } else if (sizes.inside.value > 0) {
    double sum = 0;
    for (const Triangle& t : surface.triangles) sum += longest_edge(surface, t);
    consider(kAboveTriangles * sum / static_cast<double>(surface.triangles.size()));
  }
  for (const SizeBall& ball : sizes.around) consider(ball.size.in_mm(voxel_mm));
  if (field != nullptr) {
    for (const float value : field->values) consider(static_cast<double>(value));
  }
  return smallest;
}

SizeGrid empty_grid(const Box& box, double smallest) {
  const Vec3 side = box.high - box.low;
  const auto count = [](double length, double step) { return std::ceil(length / step) + 3; };
  double step = 0.5 * smallest;
  while (count(side.x, step) * count(side.y, step) * count(side.z, step) > kMostNodes) step *= 1.05;
  SizeGrid grid;
  grid.spacing = step;
  std::size_t nodes = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    grid.origin[k] = box.low[k] - step;
    grid.nodes[k] = static_cast<std::uint32_t>(count(side[k], step));
    nodes *= grid.nodes[k];
  }
  grid.values.assign(nodes, kNoWish);
  return grid;
}

// Calls `visit(offset, position)` for the nodes in a box, cut at the grid's border.
template <class Visit>
void each_node(const SizeGrid& grid, Vec3 low, Vec3 high, Visit visit) {
  std::array<std::size_t, 3> first, last;
  for (std::size_t k = 0; k < 3; ++k) {
    const double border = static_cast<double>(grid.nodes[k] - 1);
    const double from = std::ceil((low[k] - grid.origin[k]) / grid.spacing);
    const double to = std::floor((high[k] - grid.origin[k]) / grid.spacing);
    if (from > border || to < 0) return;
    first[k] = static_cast<std::size_t>(std::max(0.0, from));
    last[k] = static_cast<std::size_t>(std::min(border, to));
  }
  const auto at = [&grid](std::size_t k, std::size_t i) {
    return grid.origin[k] + grid.spacing * static_cast<double>(i);
  };
  for (std::size_t z = first[2]; z <= last[2]; ++z) {
    for (std::size_t y = first[1]; y <= last[1]; ++y) {
      for (std::size_t x = first[0]; x <= last[0]; ++x) {
        visit(grid.offset(x, y, z), Vec3{at(0, x), at(1, y), at(2, z)});
      }
    }
  }
}

// Every node less than a cube's diagonal from a triangle: the eight nodes of each cube that it runs through
// are among them.
template <class Visit>
void each_node_near(const SizeGrid& grid, const SurfaceMesh& surface, Visit visit) {
  const double reach = 1.7320508075688774 * grid.spacing;
  const Vec3 margin{reach, reach, reach};
  for (const Triangle& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
    Vec3 low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min({a[k], b[k], c[k]});
      high[k] = std::max({a[k], b[k], c[k]});
    }
    each_node(grid, low - margin, high + margin, [&](std::size_t node, Vec3 p) {
      if (distance(p, closest_point_on_triangle(p, a, b, c)) < reach) visit(node, t);
    });
  }
}

void ask(SizeGrid& grid, std::size_t node, double size) {
  grid.values[node] = std::min(grid.values[node], static_cast<float>(size));
}

void ask_in_balls(SizeGrid& grid, Vec3 centre, const std::vector<SizeBall>& balls, double voxel_mm) {
  for (const SizeBall& ball : balls) {
    const double turn = ball.frame == SizeFrame::kRas ? -1 : 1;
    const Vec3 at = Vec3{turn * ball.at.x, turn * ball.at.y, ball.at.z} - centre;
    // Half a cube's diagonal holds a node for certain.
    const double radius = std::max(ball.radius.in_mm(voxel_mm), 0.8660254037844387 * grid.spacing);
    const Vec3 margin{radius, radius, radius};
    each_node(grid, at - margin, at + margin, [&](std::size_t node, Vec3 p) {
      if (distance(p, at) <= radius) ask(grid, node, ball.size.in_mm(voxel_mm));
    });
  }
}

// The value of the voxel that a point lies in; nothing outside the image.
std::optional<float> value_at(const Image& field, Vec3 lps) {
  const Vec3 index = field.frame.to_index(lps);
  std::array<std::int32_t, 3> voxel;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(index[k] > -0.5 && index[k] < field.frame.dims[k] - 0.5)) return std::nullopt;
    voxel[k] = static_cast<std::int32_t>(std::lround(index[k]));
  }
  return field.values[field.frame.offset(voxel[0], voxel[1], voxel[2])];
}

void ask_by_field(SizeGrid& grid, Vec3 centre, const Image& field) {
  const float lowest = *std::min_element(field.values.begin(), field.values.end());
  const float highest = *std::max_element(field.values.begin(), field.values.end());
  if (lowest < 0 || highest <= 0) {
    throw Error(ErrorKind::kInput, "tetgen.size_field",
                lowest < 0 ? fmt::format("the field of sizes holds {}", static_cast<double>(lowest))
                           : std::string("the field of sizes asks for nothing: it holds no value above 0"),
                "its values are the largest edges in mm; 0 asks for nothing");
  }
  constexpr double kFar = 1e300;
  each_node(grid, {-kFar, -kFar, -kFar}, {kFar, kFar, kFar}, [&](std::size_t node, Vec3 p) {
    const std::optional<float> value = value_at(field, p + centre);
    if (value && *value > 0) ask(grid, node, static_cast<double>(*value));
  });
}

// Makes values[n] = min over all nodes m of values[m] + slope |n - m|, along ways over neighbouring nodes: a
// chamfer transform of one sweep forward and one back, each over half of the 26 neighbours.
void limit_growth(SizeGrid& grid, std::vector<float>& values, double slope) {
  const std::array<std::ptrdiff_t, 3> n{grid.nodes[0], grid.nodes[1], grid.nodes[2]};
  for (const std::ptrdiff_t sign : {-1, 1}) {
    const auto ordered = [sign](std::ptrdiff_t i, std::ptrdiff_t count) {
      return sign < 0 ? i : count - 1 - i;
    };
    for (std::ptrdiff_t c = 0; c < n[2]; ++c) {
      for (std::ptrdiff_t b = 0; b < n[1]; ++b) {
        for (std::ptrdiff_t a = 0; a < n[0]; ++a) {
          const std::ptrdiff_t x = ordered(a, n[0]), y = ordered(b, n[1]), z = ordered(c, n[2]);
          float& value = values[static_cast<std::size_t>(x + n[0] * (y + n[1] * z))];
          for (std::ptrdiff_t neighbour = 0; neighbour < 13; ++neighbour) {
            const std::ptrdiff_t dx = neighbour % 3 - 1, dy = neighbour / 3 % 3 - 1, dz = neighbour / 9 - 1;
            const std::ptrdiff_t i = x - sign * dx, j = y - sign * dy, k = z - sign * dz;
            if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) continue;
            const double way = grid.spacing * std::sqrt(static_cast<double>(dx * dx + dy * dy + dz * dz));
            const float other = values[static_cast<std::size_t>(i + n[0] * (j + n[1] * k))];
            value = std::min(value, other + static_cast<float>(slope * way));
          }
        }
      }
    }
  }
}

}  // namespace

SizeGrid make_size_grid(const SurfaceMesh& surface, Vec3 centre, const TetgenOptions& options,
                        const Image* field, const Context& context) {
  const SizeOptions& sizes = options.sizes;
  const double voxel = surface.voxel_mm;
  const Box box = box_of(surface);
  SizeGrid grid = empty_grid(box, smallest_wish(surface, sizes, voxel, field));
  const double inside = sizes.inside.in_mm(voxel), near = sizes.near_surface.in_mm(voxel);
  if (inside > 0) std::fill(grid.values.begin(), grid.values.end(), static_cast<float>(inside));
  std::vector<float> surface_edges(grid.values.size(), kNoWish);  // negative lengths, for limit_growth
  each_node_near(grid, surface, [&](std::size_t node, const Triangle& t) {
    const double edge = longest_edge(surface, t);
    surface_edges[node] = std::min(surface_edges[node], static_cast<float>(-edge));
    if (near > 0 || inside > 0) ask(grid, node, near > 0 ? near : kAboveTriangles * edge);
  });
  context.check_cancelled();
  ask_in_balls(grid, centre, sizes.around, voxel);
  if (field != nullptr) ask_by_field(grid, centre, *field);
  limit_growth(grid, grid.values, sizes.gradation);
  if (options.preserve_surface) {
    limit_growth(grid, surface_edges, 1);
    for (std::size_t n = 0; n < grid.values.size(); ++n) {
      grid.values[n] = std::max(grid.values[n], -surface_edges[n]);
    }
  }
  // Nothing is asked for at all where no wish reaches.
  const auto most = static_cast<float>(2 * distance(box.low, box.high));
  for (float& value : grid.values) value = std::min(value, most);
  return grid;
}

}  // namespace periost
