#include "stages/improve/tet_cavity.h"

#include <algorithm>
#include <cmath>

#include "stages/improve/tet_removal.h"

namespace periost {
namespace {

constexpr std::size_t kLargestCavity = 60;
constexpr int kClimbs = 3;
constexpr double kBetter = 1.02;
constexpr double kHopeless = 0.5;  // share of the bad sine that the first cavity must reach to go on

}  // namespace

// Adds a tetrahedron: its faces towards the cavity vanish, its others become faces.
void TetCavity::take(Index tet, Vec3 place, Cavity& cavity) const {
  cavity.tets.push_back(tet);
  cavity.before = std::min(cavity.before, complex_.quality[tet]);
  std::erase_if(cavity.faces, [&](const Face& face) { return face.beyond == tet; });
  for (int side = 0; side < 4; ++side) {
    const Index beyond = complex_.neighbours[tet][as_size(side)];
    if (beyond != kNoIndex &&
        std::find(cavity.tets.begin(), cavity.tets.end(), beyond) != cavity.tets.end()) {
      continue;
    }
    Face face{tet, side, beyond, complex_.fan(tet, side), 0};
    face.sine = smallest_sine(face.fan, place);
    cavity.faces.push_back(face);
  }
}

void TetCavity::measure(Cavity& cavity) const {
  cavity.sine = 2;
  for (const Face& face : cavity.faces) cavity.sine = std::min(cavity.sine, face.sine);
}

void TetCavity::grow(const std::vector<Index>& seed, Vec3 place, double target, Cavity& best) {
  growing_.tets.clear();
  growing_.faces.clear();
  growing_.before = 2;
  for (const Index tet : seed) take(tet, place, growing_);
  measure(growing_);
  std::size_t best_size = growing_.tets.size();
  double best_sine = growing_.sine;
  while (growing_.tets.size() < kLargestCavity && growing_.sine < target) {
    const auto worst = std::min_element(growing_.faces.begin(), growing_.faces.end(),
                                        [](const Face& x, const Face& y) { return x.sine < y.sine; });
    if (worst->beyond == kNoIndex) break;
    take(worst->beyond, place, growing_);
    measure(growing_);
    if (growing_.sine <= best_sine) continue;
    best_sine = growing_.sine;
    best_size = growing_.tets.size();
  }
  if (best_size == growing_.tets.size()) {
    std::swap(best, growing_);
    return;
  }
  best.tets.clear();
  best.faces.clear();
  best.before = 2;
  for (std::size_t i = 0; i < best_size; ++i) take(growing_.tets[i], place, best);
  measure(best);
}

bool TetCavity::commit(const Cavity& cavity, Vec3 place) {
  const Index point = complex_.add_point(place);
  fresh_.clear();
  double old_volume = 0, new_volume = 0;
  const auto volume = [&](const Tetrahedron& t) {
    const auto& p = complex_.position;
    return six_volumes(p[t[0]], p[t[1]], p[t[2]], p[t[3]]);
  };
  for (const Index tet : cavity.tets) old_volume += volume(complex_.corners[tet]);
  for (const Face& face : cavity.faces) {
    const auto [a, b, c] = face_of(complex_.corners[face.inside], face.side);
    fresh_.push_back({a, c, b, point});
    new_volume += volume(fresh_.back());
  }
  const bool is_filled = std::abs(new_volume - old_volume) <= 1e-9 * old_volume;
  if (is_filled && complex_.replace(cavity.tets, fresh_)) return true;
  complex_.drop_last_point();
  return false;
}

bool TetCavity::try_place(Vec3 place, const std::vector<Index>& seed, double bad, double target,
                          std::size_t room) {
  Vec3 best_place = place;
  grow(seed, place, target, best_);
  for (int round = 0; round < kClimbs && best_.sine < target; ++round) {
    if (best_.sine < bad * kHopeless) return false;
    fans_.clear();
    for (const Face& face : best_.faces) fans_.push_back(face.fan);
    const double last = best_.sine;
    best_place = climb(fans_, best_place, target, best_.sine);
    if (best_.sine <= last) break;
    grow(seed, best_place, target, other_);
    if (other_.sine > best_.sine) std::swap(best_, other_);
    if (best_.sine <= last * kBetter) break;
  }
  if (best_.sine <= best_.before * kBetter + kLeastGain) return false;
  const double growth = static_cast<double>(best_.faces.size()) - static_cast<double>(best_.tets.size());
  if (growth > static_cast<double>(room) || best_.sine < best_.before + price_ * growth) return false;
  return commit(best_, best_place);
}

bool TetCavity::insert(Index tet, double target, std::size_t room, double price) {
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
  for (int side = 0; side < 4; ++side) {
    const Index other = complex_.neighbours[tet][as_size(side)];
    if (other == kNoIndex) continue;
    const auto [x, y, z] = kTetFace[as_size(side)];
    if (try_place((place(x) + place(y) + place(z)) / 3, {tet, other}, bad, target, room)) return true;
  }
  return false;
}

}  // namespace periost
