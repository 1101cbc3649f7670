#include "stages/decimate/certificate_fan.h"

#include <bit>
#include <cmath>

namespace periost {
namespace {

constexpr double kLeastTilt = 0.2;  // least product of a new triangle's normal with the direction

// The spoke that ends at a vertex; a new one when there is none. kMaxFan + 1 when there are too many.
std::uint32_t spoke_to(const CertifiedMesh& mesh, Index vertex, Fan& fan) {
  for (std::uint32_t i = 0; i < fan.spokes; ++i) {
    if (fan.vertex[i] == vertex) return i;
  }
  if (fan.spokes == kMaxFan) return kMaxFan + 1;
  fan.vertex[fan.spokes] = vertex;
  fan.rim[fan.spokes] = mesh.points[vertex];
  return static_cast<std::uint32_t>(fan.spokes++);
}

// The frame: z along the sum of the area vectors, so that tilts are small.
bool choose_frame(Vec3 areas, Fan& fan) {
  fan.axis_z = normalized(areas);
  if (fan.axis_z == Vec3{}) return false;
  const Vec3 n = fan.axis_z;
  const Vec3 aside = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  fan.axis_x = normalized(cross(aside, n));
  fan.axis_y = cross(n, fan.axis_x);
  for (std::size_t i = 0; i < fan.spokes; ++i) {
    fan.rim[i] = fan.to_fan(fan.rim[i]);
    fan.rim_x[i] = fan.rim[i].x;
    fan.rim_y[i] = fan.rim[i].y;
  }
  return true;
}

void set_line(std::size_t l, Vec3 from, Vec3 to, Fan& fan) {
  const Planar along{to.x - from.x, to.y - from.y};
  fan.line[l] = {
      {from.x, from.y}, along, from.z, to.z - from.z, 1 / (along.x * along.x + along.y * along.y), 0, false};
  fan.cx[l] = -along.y;
  fan.cy[l] = along.x;
  fan.c[l] = along.y * from.x - along.x * from.y;
}

// How many cells hold the direction of the positive x axis; more than one when the fan winds twice.
int windings(const Fan& fan) {
  int count = 0;
  for (std::size_t j = 0; j < fan.cells; ++j) {
    count += fan.rim[fan.cell[j].a].y <= 0 && fan.rim[fan.cell[j].b].y > 0 ? 1 : 0;
  }
  return count;
}

}  // namespace

Index apex_of(const Proposal& proposal) {
  if (proposal.moved != kNoIndex) return proposal.moved;
  for (const Index v : proposal.cells[0].corner) {
    if (proposal.cells[1].has(v)) return v;
  }
  return kNoIndex;
}

bool make_fan(const CertifiedMesh& mesh, const Proposal& proposal, Fan& fan) {
  fan.cells = proposal.cells.size();
  const Index apex = apex_of(proposal);
  if (fan.cells > kMaxFan || apex == kNoIndex) return false;
  fan.origin = proposal.point_of(mesh, apex);
  std::array<Vec3, kMaxFan> area;
  Vec3 areas;
  for (std::size_t j = 0; j < fan.cells; ++j) {
    const LinkedTriangle& cell = proposal.cells[j];
    if (!cell.has(apex)) return false;
    const std::size_t k = cell.slot_of(apex);
    const std::uint32_t a = spoke_to(mesh, cell.corner[(k + 1) % 3], fan);
    const std::uint32_t b = spoke_to(mesh, cell.corner[(k + 2) % 3], fan);
    if (a > kMaxFan || b > kMaxFan) return false;
    fan.cell[j] = {a, b, 0, 0};
    fan.is_cyclic = fan.is_cyclic && a == j && b == (j + 1) % fan.cells;
    area[j] = cross(fan.rim[a] - fan.origin, fan.rim[b] - fan.origin);
    areas += area[j];
  }
  if (fan.lines() > 2 * kMaxFan || !choose_frame(areas, fan)) return false;
  for (std::size_t i = 0; i < fan.spokes; ++i) set_line(i, {}, fan.rim[i], fan);
  for (std::size_t j = 0; j < fan.cells; ++j) {
    auto& [a, b, slope_x, slope_y] = fan.cell[j];
    const Vec3 ra = fan.rim[a], rb = fan.rim[b];
    const double det = ra.x * rb.y - ra.y * rb.x;
    if (!(det > 0) || det * det < kLeastTilt * kLeastTilt * squared_norm(area[j])) return false;
    slope_x = (ra.z * rb.y - rb.z * ra.y) / det;
    slope_y = (rb.z * ra.x - ra.z * rb.x) / det;
    const std::size_t outer = fan.spokes + j;
    set_line(outer, ra, rb, fan);
    const std::uint32_t bit = 1u << j;
    fan.line[a].cells |= bit;
    fan.line[b].cells |= bit;
    fan.line[outer].cells = bit;
    fan.line[outer].is_border = true;
    for (const std::uint32_t end : {a, b}) {
      fan.lines_at[end] |= (1u << end) | (1u << outer);
      fan.cells_at[end] |= bit;
    }
  }
  for (std::size_t i = 0; i < fan.spokes; ++i) fan.line[i].is_border = std::popcount(fan.line[i].cells) < 2;
  const bool is_closed = fan.spokes == fan.cells;
  return is_closed ? windings(fan) == 1 : fan.cells == 2;
}

}  // namespace periost
