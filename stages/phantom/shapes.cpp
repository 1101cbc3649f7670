#include "stages/phantom/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/base/random.h"

namespace periost {
namespace {

// A point of a model's skeleton with its radius, mm.
struct Node {
  Vec3 p;
  double radius;
};

void add_chain(Body& body, const std::vector<Node>& nodes) {
  for (std::size_t n = 0; n + 1 < nodes.size(); ++n) {
    body.cones.push_back({nodes[n].p, nodes[n + 1].p, nodes[n].radius, nodes[n + 1].radius});
  }
}

// The factor by which a model of size `model` fills a box.
double fit(Vec3 model, Vec3 box) {
  return std::min({box.x / model.x, box.y / model.y, box.z / model.z});
}

void scale(Body& body, double factor) {
  body.blend *= factor;
  for (RoundCone& cone : body.cones) {
    cone.a *= factor;
    cone.b *= factor;
    cone.radius_a *= factor;
    cone.radius_b *= factor;
  }
}

Vec3 random_vector(Random& random) {
  const double x = random.uniform() - 0.5;
  const double y = random.uniform() - 0.5;
  const double z = random.uniform() - 0.5;
  return {x, y, z};
}

// A branch that is about to grow from the end of another.
struct Shoot {
  Vec3 p;
  Vec3 direction;
  double radius = 0;
  double length = 0;
  int generation = 0;
  std::size_t parent = 0;  // number of the shoot that it grows from
};

// The vessels grown so far, in the model's millimetres.
struct Tree {
  std::vector<RoundCone> cones;
  std::vector<std::size_t> owner;   // of cones: the shoot
  std::vector<std::size_t> parent;  // of shoots
};

constexpr Vec3 kVesselBox{84, 84, 80};
constexpr Vec3 kVesselRoom{36, 36, 34};  // centre lines stay within this far of the middle
constexpr int kGenerations = 7;
constexpr double kGap = 1.2;  // mm between vessels that do not meet at a fork
constexpr int kPieces = 4;    // straight pieces of a branch

// Turns a direction back where it would leave the room.
Vec3 kept_inside(Vec3 p, Vec3 direction, double length) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::abs(p[a] + direction[a] * length) > kVesselRoom[a]) direction[a] = -direction[a];
  }
  return direction;
}

// Whether a ball keeps clear of all vessels but its own shoot's parent and siblings.
bool is_free(const Tree& tree, std::size_t parent, Vec3 p, double radius) {
  for (std::size_t n = 0; n < tree.cones.size(); ++n) {
    const std::size_t owner = tree.owner[n];
    if (owner == parent || tree.parent[owner] == parent) continue;
    if (depth_in(tree.cones[n], p) > -(radius + kGap)) return false;
  }
  return true;
}

// The pieces of a branch, or none when it comes too near others. The last piece ends at the next fork.
std::vector<RoundCone> grown(const Tree& tree, const Shoot& shoot, Random& random) {
  std::vector<RoundCone> pieces;
  const double step = shoot.length / kPieces;
  Vec3 p = shoot.p;
  Vec3 direction = shoot.direction;
  double radius = shoot.radius;
  for (int piece = 0; piece < kPieces; ++piece) {
    direction = normalized(direction + random_vector(random) * 0.5);
    direction = kept_inside(p, direction, step);
    const Vec3 next = p + direction * step;
    if (!is_free(tree, shoot.parent, (p + next) * 0.5, radius) || !is_free(tree, shoot.parent, next, radius))
      return {};
    pieces.push_back({p, next, radius, radius * 0.985});
    p = next;
    radius *= 0.985;
  }
  return pieces;
}

// The two shoots of a fork at the end of a branch.
std::array<Shoot, 2> forked(const Shoot& stem, const RoundCone& end, std::size_t number, Random& random) {
  // Murray: the cubes of the radii of two equal branches add up to the stem's.
  constexpr double kRadiusRatio = 0.7937;
  const Vec3 direction = normalized(end.b - end.a);
  const Vec3 sideways = normalized(cross(direction, random_vector(random) + Vec3{0.01, 0, 0}));
  const auto shoot = [&](double side) {
    return Shoot{end.b,
                 normalized(direction + sideways * side),
                 end.radius_b * kRadiusRatio,
                 stem.length * 0.84,
                 stem.generation + 1,
                 number};
  };
  return {shoot(-0.65), shoot(0.65)};
}

// 1 up to `low`, 0 from `high` on, linear between.
double fade_out(double value, double low, double high) {
  return std::clamp((high - value) / (high - low), 0.0, 1.0);
}

}  // namespace

Body ventricle_body(Vec3 box_mm) {
  Body body{{}, 3};
  for (const double side : {-1.0, 1.0}) {
    const auto at = [side](double x, double y, double z) { return Vec3{side * x, y, z}; };
    const Node atrium{at(19, -24, 7), 8.5};
    add_chain(body,
              {{at(13, 47, 0), 2}, {at(9, 34, 8), 5}, {at(8, 14, 18), 6.5}, {at(10, -10, 19), 7}, atrium});
    add_chain(body, {atrium, {at(20, -36, 1), 5}, {at(15, -50, -3), 1.8}});
    add_chain(body, {atrium, {at(26, -18, -9), 5.5}, {at(30, -2, -18), 4.5}, {at(28, 14, -23), 2}});
  }
  scale(body, fit({76, 108, 60}, box_mm));
  return body;
}

Body vessel_body(Vec3 box_mm, std::uint64_t seed) {
  constexpr int kTrials = 12;
  constexpr std::size_t kRoot = 0;
  Tree tree;
  Random random(seed, 0);
  std::vector<Shoot> shoots{{{0, 0, -34}, {0, 0, 1}, 4.1, 19, 0, kRoot}};
  for (std::size_t n = 0; n < shoots.size(); ++n) {
    const Shoot shoot = shoots[n];
    tree.parent.push_back(shoot.parent);
    std::vector<RoundCone> pieces;
    for (int trial = 0; trial < kTrials && pieces.empty(); ++trial) pieces = grown(tree, shoot, random);
    tree.cones.insert(tree.cones.end(), pieces.begin(), pieces.end());
    tree.owner.resize(tree.cones.size(), n);
    if (pieces.empty() || shoot.generation == kGenerations) continue;
    for (const Shoot& next : forked(shoot, pieces.back(), n, random)) shoots.push_back(next);
  }
  Body body{std::move(tree.cones), 0.5};
  scale(body, fit(kVesselBox, box_mm));
  return body;
}

double Femur::cortex_mm(double z) const {
  return scale * (1.8 + 4.2 * fade_out(std::abs(z) / scale, 90, 170));
}

double Femur::trabecular_share(double z) const {
  return 1 - fade_out(std::abs(z) / scale, 105, 165);
}

Femur femur(Vec3 box_mm) {
  Femur bone;
  Body& body = bone.outer;
  body.blend = 8;
  add_chain(body, {{{0, 0, 160}, 17},
                   {{-1, 3, 120}, 15},
                   {{-1, 7, 40}, 13.5},
                   {{0, 8, -30}, 13.5},
                   {{0, 5, -100}, 15},
                   {{0, 0, -165}, 22}});
  add_chain(body, {{{0, 0, -165}, 22}, {{-20, -6, -195}, 20}});
  add_chain(body, {{{0, 0, -165}, 22}, {{20, -6, -196}, 21}});
  add_chain(body, {{{-3, 0, 165}, 14}, {{18, 3, 193}, 13}});
  add_chain(body, {{{24, 4, 201}, 22}, {{24.5, 4, 201.5}, 22}});  // head
  add_chain(body, {{{-8, -1, 160}, 14}, {{-20, -3, 186}, 13}});   // greater trochanter
  add_chain(body, {{{2, -8, 128}, 9}, {{7, -15, 132}, 6}});       // lesser trochanter
  bone.scale = fit({100, 80, 460}, box_mm);
  bone.half_length = 230 * bone.scale;
  scale(body, bone.scale);
  return bone;
}

}  // namespace periost
