#include "stages/decimate/certified_schedule.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/base/parallel.h"
#include "stages/decimate/certified_contour_moves.h"
#include "stages/decimate/certified_deform.h"
#include "stages/decimate/certified_passes.h"
#include "stages/decimate/certified_regions.h"
#include "stages/decimate/certified_rescue.h"

namespace periost {
namespace {

constexpr int kStages = 6;  // removal stages by cost
// Rounds of removals of any cost, each with mending, after the last stage: on large surfaces, which they take
// long on, fewer.
constexpr std::size_t kLeastRounds = 2, kMostRounds = 12;
constexpr std::size_t kRoundTriangles = 90'000;  // that further rounds may go over, all added up
// Part of the triangles that a round must remove to go on; where the number of rounds is asked for, less.
constexpr double kWorthwhile = 0.015, kWorthwhileAsked = 0.001;
// The first of them let removals make angles down to such a part of the least one, and mend these after:
// where no removal leaves good angles at once, one with a few moves after it often does. All would leave too
// many that nothing mends.
constexpr std::array<double, 7> kBoldAngle{0.87, 0.87, 0.77, 0.77, 0.77, 0.77, 0.77};
constexpr double kAim = 1.3;  // times the least angle: what mending aims at before further removals
// Likewise before the law of motion, which needs room, too; a surface that stops at a count has it anyway.
constexpr double kLastAim = 1.15;
// Steps of the law of motion before the checks are asked; contours, which have less room, take fewer.
constexpr int kStepsAtOnce = 5, kContourStepsAtOnce = 2;
constexpr int kFits = 3;
constexpr double kLeastLoss = 0.002;  // of the volume: fitted well enough when less is lost or won
constexpr int kSliverRounds = 24, kRoundsInVain = 4;
constexpr int kSplits = 3;
constexpr double kSplitBelow = 0.75;  // of the least angle: slivers so bad are split in the hope of more
constexpr std::size_t kRegions = 4;   // that space is cut into, as long as they are not too small or large
constexpr std::size_t kLeastOfARegion = 3000, kMostOfARegion = 40'000;  // vertices
// While edges are removed, |D| may exceed the limit by this much; swaps bring it down again at the end. At
// the limit itself removals would stop at twice the triangles.
constexpr int kTopologySlack = 3;

constexpr std::size_t kCounted = 32'768;  // triangles of one task

std::size_t count_living_triangles(const CertifiedMesh& mesh, const Context& context) {
  std::atomic<std::size_t> count{0};
  parallel_blocks(context, mesh.triangles.size(), kCounted, [&](std::size_t begin, std::size_t end) {
    std::size_t living = 0;
    for (std::size_t t = begin; t < end; ++t) living += mesh.triangles[t].is_alive() ? 1 : 0;
    count += living;
  });
  return count;
}

GuardLimits limits_of(const DecimateOptions& options) {
  GuardLimits limits;
  limits.min_angle = options.min_angle.radians();
  limits.min_barycentric = options.min_barycentric;
  limits.topology = options.topology;
  limits.dihedral_cosine = -std::cos(options.min_edge_angle.radians());
  return limits;
}

// The volume under the surface, whose value without a border is what it encloses, and its area; mm.
struct Extents {
  double volume = 0, area = 0;
};
Extents extents_of(const CertifiedState& state) {
  const Vec3 origin = state.reference.points[0];
  Extents sum;
  for (Index t = 0; t < state.mesh.triangles.size(); ++t) {
    if (!state.mesh.triangles[t].is_alive()) continue;
    const auto c = corners_now(state.mesh, t);
    const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
    sum.volume += dot(c[0] - origin, normal) / 6;
    sum.area += norm(normal) / 2;
  }
  return sum;
}

// Whether all contours stay where they are, so that volumes under the surface can be compared.
bool has_locked_border(const CertifiedMesh& mesh) {
  for (Index v = 0; v < mesh.points.size(); ++v) {
    if (mesh.incident[v] != kNoIndex && mesh.is_on_contour(v) && !mesh.is_locked[v]) return false;
  }
  return true;
}

// The schedule: which passes, in what order, over which regions.
class Schedule {
 public:
  Schedule(CertifiedState& state, const DecimateOptions& options, const Context& context)
      : state_(state),
        options_(options),
        context_(context),
        progress_(context, "decimating", kStages + kMostRounds + 3),
        is_border_locked_(has_locked_border(state.mesh)),
        volume_(extents_of(state).volume),
        living_triangles_(count_living_triangles(state.mesh, context)) {}

  void run(Extent extent) {
    remove_by_cost();
    if (extent == Extent::kToTheEnd) finish();
  }

  MoveCounts counts() const {
    MoveCounts sum;
    for (const auto& worker : idle_) sum += worker->counts;
    return sum;
  }

 private:
  void remove_by_cost() {
    sweep_early([](CertifiedState& state, Worker& worker, const VertexList& vertices) {
      swap_pass(state, worker, vertices);
    });
    for (int stage = 0; stage < kStages && removals_left() > 0; ++stage) {
      const double limit = median_removal_cost(state_, context_);
      sweep_early([limit](CertifiedState& state, Worker& worker, const VertexList& vertices) {
        removal_pass(state, worker, vertices, limit);
      });
      end_step("stage");
    }
  }

  // Passes while later ones are likely to mend what these leave.
  template <class Work>
  void sweep_early(Work&& work) {
    sweep(kTopologySlack, [&work](CertifiedState& state, Worker& worker, const VertexList& vertices) {
      worker.is_thorough = false;
      work(state, worker, vertices);
      worker.is_thorough = true;
    });
  }

  void finish() {
    remove_in_rounds();
    mend_angles(removals_left() == 0 ? 1 : kLastAim);
    deform();
    mend_angles(1);
    fit();
    sweep(0, swap_pass);
    mend_slivers();
    fit();
    rescue();
    end_step("angles");
  }

  // `aim`: in least angles.
  void mend_angles(double aim) {
    sweep(kTopologySlack, [aim](CertifiedState& state, Worker& worker, const VertexList& vertices) {
      angle_pass(state, worker, vertices, aim * worker.limits.min_angle);
      contour_pass(state, worker, vertices, aim * worker.limits.min_angle);
    });
  }

  void remove_in_rounds() {
    const bool is_asked = options_.rounds > 0;
    const std::size_t most = is_asked ? static_cast<std::size_t>(options_.rounds) : kMostRounds;
    const double budget = state_.share * static_cast<double>(kRoundTriangles);
    std::size_t gone_over = 0;
    for (std::size_t round = 0; round < most; ++round) {
      const std::size_t before = living_triangles_;
      gone_over += before;
      const bool is_long = !is_asked && round + 1 >= kLeastRounds && static_cast<double>(gone_over) > budget;
      const bool is_last = is_long || round + 1 == most;
      const double bold = round < kBoldAngle.size() ? kBoldAngle[round] : 1, aim = is_last ? 1 : kAim;
      sweep(kTopologySlack, [=](CertifiedState& state, Worker& worker, const VertexList& vertices) {
        final_round(state, worker, vertices, bold, aim);
      });
      end_step("round");
      const std::size_t after = living_triangles_;
      const double least = (is_asked ? kWorthwhileAsked : kWorthwhile) * static_cast<double>(after);
      if (is_last || removals_left() == 0 || static_cast<double>(before - after) < least) break;
    }
  }

  // All of space is one region, and what removals left over is all that worker's.
  std::unique_ptr<Worker> take_lone_worker() {
    const auto regions = cut_regions(state_, std::numeric_limits<std::size_t>::max(), 0, context_);
    std::unique_ptr<Worker> worker = take_worker();
    worker->limits = limits_of(options_);
    worker->quota = std::numeric_limits<std::size_t>::max();
    worker->region_lo = regions[0].lo;
    worker->region_hi = regions[0].hi;
    lend(dead_elements(), 0, 1, *worker);
    return worker;
  }

  // The steps of the law of motion, a few at a time, within what is proved.
  void deform() {
    Motion motion;
    const int at_once = state_.mesh.contour.empty() ? kStepsAtOnce : kContourStepsAtOnce;
    for (int left = options_.iterations; left > 0; left -= at_once) {
      const int steps = std::min(left, at_once);
      const auto places = deformed_places(state_, options_, steps, motion, context_);
      sweep(kTopologySlack, [&places](CertifiedState& state, Worker& worker, const VertexList& vertices) {
        deformation_pass(state, worker, vertices, places);
      });
    }
    end_step("deformation");
  }

  // Until the surface encloses what it did at first, or nearly; once where that cannot be told.
  void fit() {
    const int rounds = is_border_locked_ ? kFits : 1;
    for (int round = 0; round < rounds; ++round) {
      const Extents now = extents_of(state_);
      const double lost = is_border_locked_ ? volume_ - now.volume : 0;
      if (is_border_locked_ && std::abs(lost) <= kLeastLoss * std::abs(volume_)) break;
      const double mean = now.area > 0 ? lost / now.area : 0;  // height by which the surface lies too low
      sweep(kTopologySlack, [mean](CertifiedState& state, Worker& worker, const VertexList& vertices) {
        fit_pass(state, worker, vertices, mean);
      });
    }
  }

  // In regions first, without insertions and then with them, then in all of space at once, so that none is
  // spared at a seam.
  void mend_slivers() {
    mend_slivers_in_regions({});
    mend_slivers_in_regions(dead_elements());
    std::unique_ptr<Worker> worker = take_lone_worker();
    mend_slivers_by(*worker);
    for (int split = 0; split < kSplits; ++split) {
      const double limit = kSplitBelow * worker->limits.min_angle;
      const VertexList vertices = sliver_vertices(state_, limit);
      if (vertices.empty()) break;
      split_pass(state_, *worker, vertices, limit);
      mend_slivers_by(*worker);
    }
    give_back_lone(std::move(worker));
  }

  // The slivers that are left, and what the fit has made worse.
  void rescue() {
    std::unique_ptr<Worker> worker = take_lone_worker();
    mend_slivers_by(*worker);
    rescue_pass(state_, *worker, context_);
    give_back_lone(std::move(worker));
  }

  // What removals left over; insertions bring it to life again.
  struct Spares {
    std::vector<Index> points, triangles;
  };
  Spares dead_elements() const {
    Spares spares;
    for (Index v = 0; v < state_.mesh.points.size(); ++v) {
      if (state_.mesh.incident[v] == kNoIndex && !state_.mesh.is_locked[v]) spares.points.push_back(v);
    }
    for (Index t = 0; t < state_.mesh.triangles.size(); ++t) {
      if (!state_.mesh.triangles[t].is_alive()) spares.triangles.push_back(t);
    }
    return spares;
  }

  // The share of one region.
  static void lend(const Spares& spares, std::size_t region, std::size_t regions, Worker& worker) {
    const auto share = [&](const std::vector<Index>& from, std::vector<Index>& to) {
      const auto at = [&](std::size_t r) {
        return from.begin() + static_cast<std::ptrdiff_t>(r * from.size() / regions);
      };
      to.assign(at(region), at(region + 1));
    };
    share(spares.points, worker.dead_points);
    share(spares.triangles, worker.dead_triangles);
  }

  void mend_slivers_in_regions(const Spares& spares) {
    const VertexList slivers = sliver_vertices(state_, limits_of(options_).min_angle);
    sweep(
        0,
        [this, &slivers](CertifiedState&, Worker& worker, const VertexList& vertices) {
          VertexList own;
          std::set_intersection(vertices.begin(), vertices.end(), slivers.begin(), slivers.end(),
                                std::back_inserter(own));
          mend_slivers_at(std::move(own), worker);
        },
        &spares);
  }

  void mend_slivers_by(Worker& worker) {
    mend_slivers_at(sliver_vertices(state_, worker.limits.min_angle), worker);
  }

  // Goes on as long as slivers become fewer, or may do so in a few rounds more.
  void mend_slivers_at(VertexList vertices, Worker& worker) {
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (int round = 0, in_vain = 0; round < kSliverRounds && in_vain < kRoundsInVain; ++round) {
      context_.check_cancelled();
      const std::uint64_t before = worker.counts.moves();
      sliver_pass(state_, worker, vertices);
      if (worker.counts.moves() == before) break;
      in_vain = vertices.size() < fewest ? 0 : in_vain + 1;
      fewest = std::min(fewest, vertices.size());
      vertices = sliver_vertices_near(state_, worker.limits.min_angle, vertices);
    }
  }

  // `bold`: the part of the least angle that removals may go down to; `aim`: what of it mending aims at.
  static void final_round(CertifiedState& state, Worker& worker, const VertexList& vertices, double bold,
                          double aim) {
    const double least = worker.limits.min_angle;
    worker.limits.min_angle *= bold;
    removal_pass(state, worker, vertices, std::numeric_limits<double>::max());
    worker.limits.min_angle = least;
    if (worker.quota == 0) return;  // as few triangles as asked: no room is needed for more removals
    swap_pass(state, worker, vertices);
    relocation_pass(state, worker, vertices);
    angle_pass(state, worker, vertices, aim * least);
    contour_pass(state, worker, vertices, aim * least);
  }

  // How many removals there may still be before the surface has no more triangles than asked.
  std::size_t removals_left() const {
    if (options_.max_triangles == 0) return std::numeric_limits<std::size_t>::max();
    const std::size_t excess = living_triangles_ - std::min(living_triangles_, options_.max_triangles);
    return (excess + 1) / 2;
  }

  // Cuts space anew and runs `work` on every region, several at a time. The largest come first, so that no
  // thread is left alone with one.
  template <class Work>
  void sweep(int topology_slack, Work&& work, const Spares* spares = nullptr) {
    const std::size_t left = removals_left();
    std::size_t living = 0;
    for (const Index t : state_.mesh.incident) living += t != kNoIndex ? 1 : 0;
    const std::size_t most = std::clamp(living / kRegions, kLeastOfARegion, kMostOfARegion);
    auto regions = cut_regions(state_, most, turn_++, context_);
    std::stable_sort(regions.begin(), regions.end(),
                     [](const Region& a, const Region& b) { return a.vertices.size() > b.vertices.size(); });
    std::atomic<std::size_t> next{0};
    const std::size_t threads =
        std::min(static_cast<std::size_t>(std::max(context_.threads, 1)), regions.size());
    parallel_for(context_, threads, [&](std::size_t) {
      std::unique_ptr<Worker> worker = take_worker();
      worker->limits = limits_of(options_);
      worker->limits.topology += topology_slack;
      for (std::size_t i = next++; i < regions.size(); i = next++) {
        const Region& region = regions[i];
        worker->region_lo = region.lo;
        worker->region_hi = region.hi;
        worker->quota = left;
        if (options_.max_triangles > 0) {
          const double share = static_cast<double>(region.vertices.size()) / static_cast<double>(living);
          worker->quota = static_cast<std::size_t>(std::ceil(share * static_cast<double>(left)));
        }
        lend(spares ? *spares : Spares{}, i, regions.size(), *worker);
        work(state_, *worker, region.vertices);
      }
      give_back(std::move(worker));
    });
    living_triangles_ = count_living_triangles(state_.mesh, context_);
  }

  void give_back(std::unique_ptr<Worker> worker) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(worker));
  }

  void give_back_lone(std::unique_ptr<Worker> worker) {
    give_back(std::move(worker));
    living_triangles_ = count_living_triangles(state_.mesh, context_);
  }

  std::unique_ptr<Worker> take_worker() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<Worker>();
    auto worker = std::move(idle_.back());
    idle_.pop_back();
    return worker;
  }

  void end_step(const char* what) {
    progress_.step();
    context_.debug("decimate.stage",
                   std::string(what) + ": " + std::to_string(living_triangles_) + " triangles");
  }

  CertifiedState& state_;
  const DecimateOptions& options_;
  const Context& context_;
  Progress progress_;
  bool is_border_locked_;
  double volume_;                 // enclosed at first, mm3
  std::size_t living_triangles_;  // after the last sweep
  unsigned turn_ = 0;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace

MoveCounts run_certified_schedule(CertifiedState& state, const DecimateOptions& options, Extent extent,
                                  const Context& context) {
  Schedule schedule(state, options, context);
  schedule.run(extent);
  return schedule.counts();
}

}  // namespace periost
