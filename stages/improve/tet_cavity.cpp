#include "stages/improve/tet_cavity.h"

#include <algorithm>
#include <cmath>

#include "stages/improve/tet_removal.h"

namespace periost {
namespace {

constexpr std::size_t kLargestCavity = 60;
constexpr int kClimbs = 3;
constexpr double kBetter = 1.02;
constexpr double kHopeless = 0.7;  // share of the bad sine that the first cavity must reach to go on

}  // namespace

// Adds a tetrahedron: its faces towards the cavity vanish, its others become faces.
void TetCavity::take(Index tet, Vec3 place, Cavity& cavity) const {
  cavity.tets.push_back(tet);
  const std::size_t size = cavity.tets.size();
  for (Face& face : cavity.faces) {
    if (face.beyond == tet && face.end == kNever) face.end = size;
  }
  for (int side = 0; side < 4; ++side) {
    const Index beyond = complex_.neighbours[tet][as_size(side)];
    if (beyond != kNoIndex &&
        std::find(cavity.tets.begin(), cavity.tets.end(), beyond) != cavity.tets.end()) {
      continue;
    }
    cavity.faces.push_back({tet, side, beyond, smallest_sine(complex_.fan(tet, side), place), size, kNever});
  }
}

void TetCavity::measure(Cavity& cavity) {
  cavity.sine = 2;
  for (std::size_t i = 0; i < cavity.faces.size(); ++i) {
    if (cavity.faces[i].sine >= cavity.sine || cavity.faces[i].end != kNever) continue;
    cavity.sine = cavity.faces[i].sine;
    cavity.worst = i;
  }
}

void TetCavity::grow(const std::vector<Index>& seed, Vec3 place, double target, Cavity& best) {
  growing_.tets.clear();
  growing_.faces.clear();
  for (const Index tet : seed) take(tet, place, growing_);
  measure(growing_);
  std::size_t best_size = growing_.tets.size();
  double best_sine = growing_.sine;
  while (growing_.tets.size() < kLargestCavity && growing_.sine < target) {
    const Index beyond = growing_.faces[growing_.worst].beyond;
    if (beyond == kNoIndex) break;
    take(beyond, place, growing_);
    measure(growing_);
    if (growing_.sine <= best_sine) continue;
    best_sine = growing_.sine;
    best_size = growing_.tets.size();
  }
  cut_back(growing_, best_size);
  std::swap(best, growing_);
}

// What the cavity was at this size.
void TetCavity::cut_back(Cavity& cavity, std::size_t size) const {
  cavity.tets.resize(size);
  std::erase_if(cavity.faces, [&](const Face& face) { return face.begin > size || face.end <= size; });
  cavity.before = 2;
  for (const Index tet : cavity.tets) cavity.before = std::min(cavity.before, complex_.quality[tet]);
  for (Face& face : cavity.faces) face.end = kNever;
  measure(cavity);
}

// The new tetrahedra fill what the old ones leave.
bool TetCavity::is_filled() const {
  double old_volume = 0, new_volume = 0;
  const auto& p = complex_.position;
  for (const Index tet : best_.tets) {
    const auto& [a, b, c, d] = complex_.corners[tet];
    old_volume += six_volumes(p[a], p[b], p[c], p[d]);
  }
  for (const Face& face : best_.faces) {
    const auto [a, b, c] = face_of(complex_.corners[face.inside], face.side);
    new_volume += six_volumes(p[a], p[c], p[b], place_);
  }
  return std::abs(new_volume - old_volume) <= 1e-9 * old_volume;
}

bool TetCavity::is_current() const {
  for (std::size_t i = 0; i < best_.tets.size(); ++i) {
    if (complex_.version[best_.tets[i]] != versions_[i]) return false;
  }
  return true;
}

bool TetCavity::make() {
  const Index point = complex_.add_point(place_);
  fresh_.clear();
  for (const Face& face : best_.faces) {
    const auto [a, b, c] = face_of(complex_.corners[face.inside], face.side);
    fresh_.push_back({a, c, b, point});
  }
  if (complex_.replace(best_.tets, fresh_)) return true;
  complex_.drop_last_point();
  return false;
}

bool TetCavity::try_place(Vec3 place, const std::vector<Index>& seed, double bad, double target,
                          std::size_t room) {
  place_ = place;
  grow(seed, place, target, best_);
  for (int round = 0; round < kClimbs && best_.sine < target; ++round) {
    if (best_.sine < bad * kHopeless) return false;
    fans_.clear();
    for (const Face& face : best_.faces) fans_.push_back(complex_.fan(face.inside, face.side));
    const double last = best_.sine;
    place_ = climb(fans_, place_, target, best_.sine);
    if (best_.sine <= last) break;
    grow(seed, place_, target, other_);
    if (other_.sine > best_.sine) std::swap(best_, other_);
    if (best_.sine <= last * kBetter) break;
  }
  if (best_.sine <= best_.before * kBetter + kLeastGain) return false;
  const auto more = static_cast<double>(growth());
  if (more > static_cast<double>(room) || best_.sine < best_.before + price_ * more || !is_filled())
    return false;
  versions_.clear();
  for (const Index one : best_.tets) versions_.push_back(complex_.version[one]);
  return true;
}

bool TetCavity::find(Index tet, double target, std::size_t room, double price) {
  price_ = price;
  const Tetrahedron c = complex_.corners[tet];
  const double bad = complex_.quality[tet];
  const auto place = [&](int i) { return complex_.position[c[as_size(i)]]; };
  const Vec3 centre = 0.25 * (place(0) + place(1) + place(2) + place(3));
  if (try_place(centre, {tet}, bad, target, room)) return true;
  for (const auto& [i, j] : kTetEdge) {
    if (!complex_.ring(tet, c[as_size(i)], c[as_size(j)], kLargestCavity / 2, seed_, points_)) continue;
    if (try_place(0.5 * (place(i) + place(j)), seed_, bad, target, room)) return true;
  }
  return false;
}

}  // namespace periost
