#include "lodestone/experiments/trial_obstacles.h"

#include "lodestone/common/error.h"
#include "lodestone/experiments/trial.h"
#include "lodestone/geometry/keep_out.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {
namespace {

constexpr int kMostObstacleDraws = 100000;

}  // namespace

void check_obstacles(const TrialObstaclesConfig& config, const rig::RigConfig& rig, const std::string& task) {
  if (config.count == 0) return;
  const std::string what = "trials.obstacles.count = " + std::to_string(config.count) + ": ";
  if (rig.real())
    throw common::ConfigError(what +
                              "only the dish of a virtual rig has obstacles that are drawn; of those that "
                              "stand in a real one tell safety.keep_out");
  if (rig.needle.is_sphere())
    throw common::ConfigError(what + "a sphere (rig.needle.shape) is simulated in an empty dish");
  if (task != "point" && task != "pose")
    throw common::ConfigError(what + "task = \"" + task +
                              "\" must be point or pose: there is a way around obstacles to a point, and "
                              "none along a path that leads through them");
  if (config.diameter_m >= 2.0 * rig.dish.radius_m)
    throw common::ConfigError("trials.obstacles.diameter_m = " + std::to_string(config.diameter_m) +
                              ": the dish is only " + std::to_string(2.0 * rig.dish.radius_m) +
                              " m across (rig.dish.radius_m)");
}

std::vector<physics::ObstacleConfig> draw_obstacles(const TrialObstaclesConfig& config,
                                                    const rig::RigConfig& rig, const TrialPlan& plan,
                                                    double clearance_m, common::RandomStream random) {
  const double radius_m = 0.5 * config.diameter_m;
  geometry::KeepOut alone = plan.keep_out;
  std::vector<physics::ObstacleConfig> discs;
  for (int draws = 0; static_cast<std::int64_t>(discs.size()) < config.count;) {
    if (++draws > kMostObstacleDraws)
      throw common::ConfigError("trials.obstacles.diameter_m = " + std::to_string(config.diameter_m) +
                                ": no place clear of start and target was found for every obstacle; use "
                                "smaller ones, or a smaller route.clearance_m");
    const geometry::Vector2 centre_m = task::draw_in_disc(rig.dish.radius_m - radius_m, random);
    physics::ObstacleConfig disc;
    disc.centre_m = {centre_m.x(), centre_m.y()};
    disc.radius_m = radius_m;
    alone.zones = {zone_of(disc, "")};
    if (alone.clearance_m(plan.start) > alone.margin_m + clearance_m &&
        alone.clearance_m(plan.target_m, plan.target_m) > alone.any_way_m() + clearance_m)
      discs.push_back(disc);
  }
  return discs;
}

geometry::Zone zone_of(const physics::ObstacleConfig& disc, const std::string& name) {
  return {name, disc.centre_m, disc.radius_m};
}

}  // namespace lodestone::experiments
