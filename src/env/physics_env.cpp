#include "lodestone/env/physics_env.h"

#include <algorithm>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::env {
namespace {

constexpr std::size_t kPhysicsShardRows = 16;

/// The simulator's wall stops the needle on the very edge of the dish, where rounding would decide whether it
/// has left. Touching the wall counts as having left, as it does in the MBS, which has no wall.
geometry::Pose2 beyond_wall_when_touching(geometry::Pose2 pose, double dish_radius_m) {
  constexpr double kTouch = 1e-6;
  if (pose.position_m().norm() < dish_radius_m * (1.0 - kTouch)) return pose;
  pose.x_m *= 1.0 + 2.0 * kTouch;
  pose.y_m *= 1.0 + 2.0 * kTouch;
  return pose;
}

}  // namespace

PhysicsEnv::PhysicsEnv(const EpisodeSettings& settings, const physics::RigDescription& rig,
                       const PhysicsEnvConfig& config, std::int64_t threads)
    : rig_(rig),
      drive_(rig),
      config_(config),
      drawn_(static_cast<std::size_t>(settings.count)),
      simulators_(config.randomise.enabled ? drawn_.size() : 1,
                  physics::PlainSimulator(rig, config.simulator)),
      episodes_(settings, {config.pose_noise_m, config.heading_noise_rad}, "physics"),
      pool_(static_cast<std::size_t>(threads)) {
  if (rig.needle.is_sphere() && settings.encoder.heading != task::HeadingEncoding::kNone)
    throw common::ConfigError("encoder.heading = \"" + common::name_of(settings.encoder.heading) +
                              "\", but a sphere has no heading; set it to \"none\"");
  if (settings.action.size != drive_.size())
    throw common::ConfigError("an action is of " + std::to_string(settings.action.size) +
                              " numbers, the rig's drive of " + std::to_string(drive_.size()) +
                              "; leave the dynamics out, or take those of this rig");
  reset();
}

std::size_t PhysicsEnv::shards() const {
  return (static_cast<std::size_t>(episodes_.spec().count) + kPhysicsShardRows - 1) / kPhysicsShardRows;
}

void PhysicsEnv::begin(std::size_t i) {
  const double radius_m = episodes_.settings().task.start_radius_m();
  const task::Region* region = episodes_.settings().region.get();
  episodes_.begin(i, [radius_m, region](common::RandomStream& random) {
    const auto draw = [&] { return task::draw_in_disc(radius_m, random); };
    const geometry::Vector2 position_m = region != nullptr ? region->draw(draw) : draw();
    return geometry::Pose2{position_m.x(), position_m.y(), random.uniform(-geometry::kPi, geometry::kPi)};
  });
  if (!config_.randomise.enabled) return;
  common::RandomStream& random = episodes_.random(i);
  const RandomisationConfig& ranges = config_.randomise;
  drawn_[i] = {ranges.moment.draw(random), ranges.viscosity.draw(random), ranges.friction.draw(random)};
  simulators_[i] = simulator_with(drawn_[i]);
}

physics::PlainSimulator PhysicsEnv::simulator_with(const Drawn& drawn) const {
  physics::RigDescription rig = rig_;
  rig.needle.moment_A_m2 *= drawn[0];
  rig.fluid.viscosity_Pa_s *= drawn[1];
  rig.friction.static_coefficient *= drawn[2];
  rig.friction.kinetic_coefficient *= drawn[2];
  return physics::PlainSimulator(rig, config_.simulator);
}

Snapshot PhysicsEnv::save() const {
  Snapshot snapshot = episodes_.save();
  if (!config_.randomise.enabled) return snapshot;
  std::vector<double> numbers;
  for (const Drawn& drawn : drawn_) numbers.insert(numbers.end(), drawn.begin(), drawn.end());
  snapshot.arrays["drawn"] = {std::move(numbers), {episodes_.spec().count, 3}};
  return snapshot;
}

void PhysicsEnv::load(const Snapshot& snapshot) {
  episodes_.load(snapshot);
  if (!config_.randomise.enabled) return;
  const auto* number = snapshot_numbers<double>(snapshot, "drawn", {episodes_.spec().count, 3});
  for (std::size_t i = 0; i < drawn_.size(); ++i, number += 3) {
    std::copy_n(number, 3, drawn_[i].begin());
    simulators_[i] = simulator_with(drawn_[i]);
  }
}

const std::vector<float>& PhysicsEnv::reset() {
  for (std::size_t i = 0; i < static_cast<std::size_t>(episodes_.spec().count); ++i) begin(i);
  return episodes_.observation();
}

void PhysicsEnv::step_one(std::size_t i, const float* action) {
  const geometry::Drive drive_A = episodes_.drive(i, action);
  geometry::Pose2 next = episodes_.pose(i);
  if (!drive_A.isZero(0.0)) {
    next = simulators_[simulators_.size() > 1 ? i : 0].step(
        next, drive_.current_A(drive_A, next.position_m()), config_.pulse_s, config_.rest_s);
    next = beyond_wall_when_touching(next, rig_.dish.radius_m);
  }
  if (episodes_.finish(i, next)) begin(i);
}

const StepResult& PhysicsEnv::step(const std::vector<float>& actions) {
  episodes_.check_actions(actions);
  const float* values = actions.data();
  const auto count = static_cast<std::size_t>(episodes_.spec().count);
  const auto size = static_cast<std::size_t>(episodes_.spec().action_size);
  pool_.for_each(shards(), [this, values, count, size](std::size_t shard) {
    const std::size_t last = std::min(count, (shard + 1) * kPhysicsShardRows);
    for (std::size_t i = shard * kPhysicsShardRows; i < last; ++i) step_one(i, values + size * i);
  });
  return episodes_.result();
}

}  // namespace lodestone::env
