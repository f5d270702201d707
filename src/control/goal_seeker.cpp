#include "lodestone/control/goal_seeker.h"

#include "lodestone/geometry/saturation.h"
#include "lodestone/task/task.h"

namespace lodestone::control {

GoalSeeker::GoalSeeker(std::unique_ptr<Controller> inner, const GoalSeekerConfig& config,
                       double dish_radius_m, common::RandomStream random)
    : inner_(std::move(inner)), config_(config), dish_radius_m_(dish_radius_m), random_(random) {}

void GoalSeeker::draw_target() {
  target_m_ = task::draw_in_disc(config_.goal_radius * dish_radius_m_, random_);
  steps_ = 0;
}

void GoalSeeker::reset() {
  inner_->reset();
  draw_target();
}

geometry::Vector2 GoalSeeker::act(const task::Observation& observation) {
  const double distance_m = (observation.pose.position_m() - target_m_).norm();
  if (distance_m < config_.reached_m || steps_ >= config_.max_pulses_per_target) draw_target();
  ++steps_;
  task::Observation seen = observation;
  seen.target_m = target_m_;
  const geometry::Vector2 noise(random_.normal(), random_.normal());
  return geometry::saturated(inner_->act(seen) + config_.noise * noise);
}

}  // namespace lodestone::control
