#include "lodestone/experiments/routing.h"

#include <fmt/core.h>

#include <cstdint>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/control/motion_model.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/drive.h"

namespace lodestone::experiments {
namespace {

/// The part of the dish that the middle of a needle comes to.
task::Region middles(const DeploymentConfig& config) {
  return task::Region::disc(config.rig.reach_m(), config.route.region.cell_m);
}

std::vector<runs::PointMm> points_mm(const std::vector<geometry::Vector2>& points_m) {
  std::vector<runs::PointMm> points;
  for (const geometry::Vector2& point_m : points_m)
    points.push_back({geometry::kMmPerM * point_m.x(), geometry::kMmPerM * point_m.y()});
  return points;
}

}  // namespace

std::vector<task::Move> simulated_moves(const DeploymentConfig& config, const SimulatorSource& simulator) {
  if (!simulator.simulator->sampled)
    throw common::ConfigError(
        "route.moves = \"simulated\" needs a simulator that predicts distributions (train-dynamics with "
        "model.components above 0); use \"recorded\"");
  control::MotionModel model = motion_model(simulator, config.identification);
  common::RandomStream random(static_cast<std::uint64_t>(config.seed), "simulated moves");
  const double half_m = 0.5 * config.route.region.cell_m;
  std::vector<task::Move> moves;
  for (const geometry::Vector2& centre_m : middles(config).centres_m()) {
    for (std::int64_t pulse = 0; pulse < config.route.simulated_pulses; ++pulse) {
      geometry::Pose2 before;
      before.x_m = centre_m.x() + random.uniform(-half_m, half_m);
      before.y_m = centre_m.y() + random.uniform(-half_m, half_m);
      before.heading_rad = random.uniform(-geometry::kPi, geometry::kPi);
      const double scale_A = simulator.action.scale;
      const geometry::Drive drive_A =
          geometry::drawn_drive(simulator.action.size, [&] { return random.uniform(-scale_A, scale_A); });
      const geometry::Pose2 after = model.draw(before, drive_A, random);
      if (after.position_m().norm() <= config.rig.dish.radius_m)
        moves.push_back({before.position_m(), after.position_m()});
    }
  }
  return moves;
}

std::shared_ptr<const task::RouteMap> route_map(const DeploymentConfig& config,
                                                const SimulatorSource* simulator,
                                                const inference::Policy* policy) {
  const task::RouteConfig& route = config.route;
  const bool zones = config.safety.has_zones() || config.trials.obstacles.count > 0;
  const bool wanted = route.use == task::RouteUse::kAlways || (route.use == task::RouteUse::kZones && zones);
  if (!wanted) return nullptr;
  const bool simulated = route.moves == task::MovesFrom::kSimulated;
  if (simulated && simulator == nullptr)
    throw common::ConfigError(
        "route.moves = \"simulated\" needs a learned simulator: --set dynamics=DIR; or use \"recorded\"");
  std::vector<task::Move> moves;
  if (simulator != nullptr)
    moves = simulated ? simulated_moves(config, *simulator) : simulator->simulator->recorded_moves;
  if (!moves.empty())
    return std::make_shared<const task::RouteMap>(task::Region(moves, route.region), moves, route);
  return std::make_shared<const task::RouteMap>(
      policy != nullptr && policy->region ? *policy->region : middles(config), moves, route);
}

void check_keeps_out(const geometry::KeepOut& keep_out, const geometry::Vector2& from_m,
                     const geometry::Vector2& to_m, const std::string& what) {
  for (const geometry::Zone& zone : keep_out.zones) {
    const double clearance_m = zone.distance_m(from_m, to_m) - 0.5 * keep_out.needle_diameter_m;
    if (clearance_m > keep_out.margin_m) continue;
    throw common::ConfigError(fmt::format(
        "{} would have the needle {:.1f} mm from the keep-out zone {}, within the margin of {:.1f} mm "
        "(safety.keep_out, safety.keep_out_margin_m); choose another, or smaller zones",
        what, geometry::kMmPerM * clearance_m, zone.called(), geometry::kMmPerM * keep_out.margin_m));
  }
}

runs::ReachMap reach_map_of(const task::RouteMap& map) {
  runs::ReachMap reach;
  reach.cell_mm = geometry::kMmPerM * map.region().cell_m();
  reach.reachable_mm = points_mm(map.region().centres_m());
  reach.dead_mm = points_mm(map.dead_m());
  return reach;
}

}  // namespace lodestone::experiments
