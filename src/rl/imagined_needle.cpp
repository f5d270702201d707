#include "lodestone/rl/imagined_needle.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::rl {
namespace {

constexpr double kMostLogGain = 1.1;  // beyond a factor of three it is another rig
constexpr double kNearest_m = 2e-4;   // of the goals that lie near

double within_most(double log_gain) { return std::clamp(log_gain, -kMostLogGain, kMostLogGain); }

}  // namespace

double ImaginedNeedle::factor() const { return std::exp(log_gain + log_place); }

void ImaginedNeedle::put(const geometry::Pose2& there, const ImaginationConfig& config,
                         common::RandomStream& random) {
  pose = there;
  place_m = pose.position_m();
  log_place = config.place_sigma * random.normal();
  last_action.setZero();
  last_displacement_m.setZero();
}

void ImaginedNeedle::draw_rig(const ImaginationConfig& config, common::RandomStream& random) {
  told = task::draw_gain_estimate(config.gain_sigma, config.least_gain_sigma, random);
  told.log_mean = within_most(told.log_mean);
  log_gain = within_most(told.log_mean + told.log_sigma * random.normal());
}

void ImaginedNeedle::note_pulse(const geometry::Drive& action, const geometry::Vector2& before_m,
                                const ImaginationConfig& config, common::RandomStream& random) {
  last_action = action;
  last_displacement_m = pose.position_m() - before_m;
  if ((pose.position_m() - place_m).norm() <= config.place_size_m) return;
  place_m = pose.position_m();
  log_place = config.place_sigma * random.normal();
}

std::optional<geometry::Vector2> draw_near_m(const geometry::Vector2& place_m, const ImaginedTask& task,
                                             common::RandomStream& random) {
  const double distance_m = draw_log_uniform(kNearest_m, task.task.dish_radius_m, random);
  const double angle_rad = random.uniform(-geometry::kPi, geometry::kPi);
  const geometry::Vector2 near_m =
      place_m + distance_m * geometry::Vector2(std::cos(angle_rad), std::sin(angle_rad));
  if (near_m.norm() > task.task.goal_radius_m() || (task.region && !task.region->contains(near_m)))
    return std::nullopt;
  return near_m;
}

double draw_log_uniform(double least, double most, common::RandomStream& random) {
  return least * std::pow(most / least, random.uniform());
}

}  // namespace lodestone::rl
