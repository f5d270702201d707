#include "lodestone/dynamics/region_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/folded_dynamics.h"

namespace lodestone::dynamics {
namespace {

constexpr std::int64_t kDraws = 999;  // with the motion itself 1000, of which every region is a whole number
constexpr std::int64_t kMostRows = 10000;
constexpr int kRegionPercents[] = {50, 90, 99};
constexpr std::uint64_t kDrawSeed = 1;

using State = std::array<double, 3>;  // x_m, y_m, heading_rad; of a position the last is 0

struct Gaussian {
  double weight = 0.0;
  State mean{};
  State spread{};
};

using Mixture = std::vector<Gaussian>;

/// Of the position alone and of the whole pose, each but for a factor that is the same everywhere.
struct Density {
  double position = 0.0;
  double pose = 0.0;
};

/// What all members together predict for one row.
Mixture mixture_of(const std::vector<inference::FoldedDynamics>& members, const double* state,
                   const double* action, inference::FoldedDynamics::Workspace& workspace) {
  Mixture mixture;
  for (const inference::FoldedDynamics& member : members) {
    const inference::PredictedMixture predicted = member.predict_mixture(state, action, 1, workspace);
    const auto size = static_cast<std::size_t>(member.state_size());
    for (std::size_t k = 0; k < predicted.weight.size(); ++k) {
      Gaussian& one = mixture.emplace_back();
      one.weight = predicted.weight[k] / static_cast<double>(members.size());
      std::copy_n(predicted.mean.begin() + static_cast<std::ptrdiff_t>(k * size), size, one.mean.begin());
      std::copy_n(predicted.spread.begin() + static_cast<std::ptrdiff_t>(k * size), size, one.spread.begin());
    }
  }
  return mixture;
}

/// Of a normal turn, wound around the circle.
double turn_density(double turn_rad, double spread_rad) {
  const double turn = geometry::wrap_angle(turn_rad);
  double sum = 0.0;
  for (int winding = -1; winding <= 1; ++winding) {
    const double error = (turn + 2.0 * geometry::kPi * winding) / spread_rad;
    sum += std::exp(-0.5 * error * error);
  }
  return sum / spread_rad;
}

Density density_at(const Mixture& mixture, const double* state, int size) {
  Density density;
  for (const Gaussian& one : mixture) {
    const double x = (state[0] - one.mean[0]) / one.spread[0];
    const double y = (state[1] - one.mean[1]) / one.spread[1];
    const double here = one.weight * std::exp(-0.5 * (x * x + y * y)) / (one.spread[0] * one.spread[1]);
    density.position += here;
    if (size == 3) density.pose += here * turn_density(state[2] - one.mean[2], one.spread[2]);
  }
  return density;
}

State draw_state(const Mixture& mixture, common::RandomStream& random) {
  double left = random.uniform();
  std::size_t chosen = 0;
  while (chosen + 1 < mixture.size() && left >= mixture[chosen].weight) left -= mixture[chosen++].weight;
  const Gaussian& one = mixture[chosen];
  State state{};
  for (std::size_t i = 0; i < state.size(); ++i) state[i] = one.mean[i] + one.spread[i] * random.normal();
  return state;
}

/// Counts motions by the smallest region that holds them.
class Tally {
 public:
  /// A motion, and how many of the draws are at least as dense as it is.
  void add(std::int64_t denser) {
    ++motions_;
    for (const int percent : kRegionPercents)
      inside_[percent] += 100 * (denser + 1) <= percent * (kDraws + 1) ? 1 : 0;
  }
  runs::RegionCoverage::ByPercent shares() const {
    runs::RegionCoverage::ByPercent of_region;
    for (const auto& [percent, count] : inside_) {
      const common::Interval interval = common::wilson_interval(count, motions_);
      runs::CoveredFraction& covered = of_region[percent];
      covered.fraction = static_cast<double>(count) / static_cast<double>(motions_);
      covered.interval = {interval.low, interval.high};
    }
    return of_region;
  }

 private:
  std::int64_t motions_ = 0;
  std::map<int, std::int64_t> inside_;
};

}  // namespace

std::optional<runs::RegionCoverage> region_coverage(const Model& model, const data::TransitionTable& table) {
  if (model.config.components == 0 || table.size() == 0) return std::nullopt;
  std::vector<inference::FoldedDynamics> members;
  for (const auto& member : model.members) members.push_back(fold(*member));
  inference::FoldedDynamics::Workspace workspace;
  Tally position;
  Tally pose;
  runs::RegionCoverage coverage;
  const std::int64_t stride = (table.size() + kMostRows - 1) / kMostRows;
  for (std::int64_t row = 0; row < table.size(); row += stride) {
    const auto at = static_cast<std::size_t>(row * table.state_size);
    const double* action = &table.action[static_cast<std::size_t>(row * table.action_size)];
    const Mixture mixture = mixture_of(members, &table.state[at], action, workspace);
    const Density seen = density_at(mixture, &table.next_state[at], table.state_size);
    common::RandomStream random(kDrawSeed, "region coverage", static_cast<std::uint64_t>(row));
    std::int64_t denser_positions = 0;
    std::int64_t denser_poses = 0;
    for (std::int64_t i = 0; i < kDraws; ++i) {
      const Density drawn = density_at(mixture, draw_state(mixture, random).data(), table.state_size);
      denser_positions += drawn.position >= seen.position ? 1 : 0;
      denser_poses += drawn.pose >= seen.pose ? 1 : 0;
    }
    position.add(denser_positions);
    pose.add(denser_poses);
    ++coverage.n;
  }
  coverage.position = position.shares();
  if (table.state_size == 3) coverage.pose = pose.shares();
  return coverage;
}

}  // namespace lodestone::dynamics
