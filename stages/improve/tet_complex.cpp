#include "stages/improve/tet_complex.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pipeline/base/error.h"

namespace periost {
namespace {

// The other two corners, so that (i, j, k, l) is an even permutation.
constexpr int kRest[4][4][2] = {{{0, 0}, {2, 3}, {3, 1}, {1, 2}},
                                {{3, 2}, {0, 0}, {0, 3}, {2, 0}},
                                {{1, 3}, {3, 0}, {0, 0}, {0, 1}},
                                {{2, 1}, {0, 2}, {1, 0}, {0, 0}}};

Triangle sorted_face(const Tetrahedron& tet, int side) {
  auto [a, b, c] = face_of(tet, side);
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  return {a, b, c};
}

std::size_t hash_of(const Triangle& key) {
  return (key[0] * std::size_t{0x9E3779B1} + key[1] * std::size_t{0x85EBCA77} + key[2]) * 0xC2B2AE3D;
}

}  // namespace

TetComplex::TetComplex(TetMesh mesh)
    : position(std::move(mesh.points)),
      corners(std::move(mesh.tets)),
      neighbours(tet_neighbours(corners, position.size())),
      region(std::move(mesh.region)) {
  const std::size_t count = corners.size();
  region.resize(count, 1);
  quality.resize(count);
  version.assign(count, 0);
  marks_.assign(count, 0);
  tet_at.assign(position.size(), kNoIndex);
  is_on_wall.assign(position.size(), 0);
  live = count;
  for (Index t = 0; t < count; ++t) {
    quality[t] = measure(t);
    for (const Index point : corners[t]) tet_at[point] = t;
    for (int side = 0; side < 4; ++side) {
      Index& other = neighbours[t][as_size(side)];
      if (other != kNoIndex && region[other] != region[t]) other = kNoIndex;
      if (other != kNoIndex) continue;
      for (const Index point : face_of(corners[t], side)) is_on_wall[point] = 1;
    }
  }
}

int TetComplex::corner_of(Index tet, Index point) const {
  const Tetrahedron& c = corners[tet];
  return c[0] == point ? 0 : c[1] == point ? 1 : c[2] == point ? 2 : 3;
}

bool TetComplex::has_corner(Index tet, Index point) const {
  const Tetrahedron& c = corners[tet];
  return c[0] == point || c[1] == point || c[2] == point || c[3] == point;
}

int TetComplex::side_towards(Index tet, Index neighbour) const {
  for (int side = 0; side < 4; ++side) {
    if (neighbours[tet][as_size(side)] == neighbour) return side;
  }
  return -1;
}

double TetComplex::measure(const Tetrahedron& tet) const {
  return smallest_sine(position[tet[0]], position[tet[1]], position[tet[2]], position[tet[3]]);
}

double TetComplex::measure(Index tet) const {
  return measure(corners[tet]);
}

TetFan TetComplex::fan(Index tet, int corner) const {
  const auto [a, b, c] = face_of(corners[tet], corner);
  return {position[a], position[c], position[b]};
}

bool TetComplex::mark(Index tet) {
  if (marks_[tet] == stamp_) return false;
  marks_[tet] = stamp_;
  return true;
}

void TetComplex::star(Index point, std::vector<Index>& tets) const {
  tets.assign(1, tet_at[point]);
  for (std::size_t i = 0; i < tets.size(); ++i) {
    const Index tet = tets[i];
    for (std::size_t side = 0; side < 4; ++side) {
      if (corners[tet][side] == point) continue;
      const Index other = neighbours[tet][side];
      // Stars are small: looking through one is faster than marks.
      if (other != kNoIndex && std::find(tets.begin(), tets.end(), other) == tets.end()) {
        tets.push_back(other);
      }
    }
  }
}

bool TetComplex::ring(Index tet, Index a, Index b, std::size_t longest, std::vector<Index>& tets,
                      std::vector<Index>& points) const {
  tets.clear();
  points.clear();
  const auto& rest = kRest[corner_of(tet, a)][corner_of(tet, b)];
  const Index first = corners[tet][as_size(rest[0])];
  Index from = first, to = corners[tet][as_size(rest[1])];
  for (Index current = tet;;) {
    tets.push_back(current);
    points.push_back(from);
    if (tets.size() > longest) return false;
    const Index next = neighbours[current][as_size(corner_of(current, from))];
    if (next == kNoIndex) return false;
    if (next == tet) return to == first;
    from = to;
    for (const Index corner : corners[next]) {
      if (corner != a && corner != b && corner != from) to = corner;
    }
    current = next;
  }
}

bool TetComplex::take_face(const Face& face) {
  const std::size_t mask = table_.size() - 1;
  for (std::size_t i = hash_of(face.key) >> 7 & mask;; i = (i + 1) & mask) {
    if (table_[i] == kNoIndex) {
      table_[i] = static_cast<Index>(faces_.size());
      faces_.push_back(face);
      return true;
    }
    Face& known = faces_[table_[i]];
    if (known.key != face.key) continue;
    if (known.is_matched || face.is_outside) return false;
    known.is_matched = true;
    known.other = static_cast<Index>(faces_.size());
    Face copy = face;
    copy.is_matched = true;
    copy.other = table_[i];
    faces_.push_back(copy);
    return true;
  }
}

bool TetComplex::match_faces(const std::vector<Index>& old, const std::vector<Tetrahedron>& fresh) {
  std::size_t size = 32;
  while (size < 8 * (old.size() + fresh.size())) size *= 2;
  table_.assign(size, kNoIndex);
  faces_.clear();
  clear_marks();
  for (const Index tet : old) {
    if (!mark(tet)) return false;
  }
  for (const Index tet : old) {
    for (int side = 0; side < 4; ++side) {
      const Index other = neighbours[tet][as_size(side)];
      if (other != kNoIndex && is_marked(other)) continue;
      Face face{sorted_face(corners[tet], side), other, 0, true, false, kNoIndex};
      if (other != kNoIndex) face.side = side_towards(other, tet);
      if (!take_face(face)) return false;
    }
  }
  for (Index t = 0; t < fresh.size(); ++t) {
    for (int side = 0; side < 4; ++side) {
      if (!take_face({sorted_face(fresh[t], side), t, side, false, false, kNoIndex})) return false;
    }
  }
  return std::all_of(faces_.begin(), faces_.end(), [](const Face& face) { return face.is_matched; });
}

Index TetComplex::take_slot() {
  if (!free_slots_.empty()) {
    const Index slot = free_slots_.back();
    free_slots_.pop_back();
    return slot;
  }
  corners.emplace_back();
  neighbours.emplace_back();
  region.push_back(0);
  quality.push_back(0);
  version.push_back(0);
  marks_.push_back(0);
  return static_cast<Index>(corners.size() - 1);
}

bool TetComplex::replace(const std::vector<Index>& old, const std::vector<Tetrahedron>& fresh) {
  if (!match_faces(old, fresh)) return false;
  const std::int32_t number = region[old[0]];
  for (const Index tet : old) {
    for (const Index point : corners[tet]) tet_at[point] = kNoIndex;
    corners[tet][0] = kNoIndex;
    ++version[tet];
  }
  placed.clear();
  for (std::size_t i = 0; i < fresh.size(); ++i) placed.push_back(i < old.size() ? old[i] : take_slot());
  for (std::size_t i = old.size(); i-- > fresh.size();) free_slots_.push_back(old[i]);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    const Index slot = placed[i];
    corners[slot] = fresh[i];
    region[slot] = number;
    quality[slot] = measure(slot);
    ++version[slot];
    for (const Index point : fresh[i]) tet_at[point] = slot;
  }
  for (const Face& face : faces_) {
    if (face.is_outside) continue;
    const Face& other = faces_[face.other];
    const Index slot = placed[face.tet];
    if (!other.is_outside) {
      neighbours[slot][as_size(face.side)] = placed[other.tet];
      continue;
    }
    neighbours[slot][as_size(face.side)] = other.tet;
    if (other.tet != kNoIndex) neighbours[other.tet][as_size(other.side)] = slot;
  }
  live += fresh.size();
  live -= old.size();
  return true;
}

Index TetComplex::add_point(Vec3 place) {
  position.push_back(place);
  tet_at.push_back(kNoIndex);
  is_on_wall.push_back(0);
  return static_cast<Index>(position.size() - 1);
}

void TetComplex::drop_last_point() {
  PERIOST_ASSERT(tet_at.back() == kNoIndex);
  position.pop_back();
  tet_at.pop_back();
  is_on_wall.pop_back();
}

void TetComplex::move(Index point, Vec3 place, const std::vector<Index>& star) {
  position[point] = place;
  for (const Index tet : star) {
    quality[tet] = measure(tet);
    ++version[tet];
  }
}

std::string check_complex(const TetComplex& complex) {
  std::size_t live = 0;
  for (Index t = 0; t < complex.corners.size(); ++t) {
    if (!complex.is_live(t)) continue;
    ++live;
    const auto& [a, b, c, d] = complex.corners[t];
    const auto& p = complex.position;
    if (!(six_volumes(p[a], p[b], p[c], p[d]) > 0)) return fmt::format("tetrahedron {} is inverted", t);
    if (complex.quality[t] != complex.measure(t)) return fmt::format("quality of {} is stale", t);
    for (const Index point : complex.corners[t]) {
      const Index tet = complex.tet_at[point];
      if (tet == kNoIndex || !complex.is_live(tet) || !complex.has_corner(tet, point)) {
        return fmt::format("point {} is not in its tetrahedron", point);
      }
    }
    for (int side = 0; side < 4; ++side) {
      const Index other = complex.neighbours[t][as_size(side)];
      if (other == kNoIndex) continue;
      if (!complex.is_live(other)) return fmt::format("{} has the dropped neighbour {}", t, other);
      const int back = complex.side_towards(other, t);
      if (back < 0) return fmt::format("{} and {} are not mutual neighbours", t, other);
      if (sorted_face(complex.corners[t], side) != sorted_face(complex.corners[other], back)) {
        return fmt::format("{} and {} do not share a face", t, other);
      }
    }
  }
  if (live != complex.live) return fmt::format("{} tetrahedra are counted as {}", live, complex.live);
  return {};
}

}  // namespace periost
