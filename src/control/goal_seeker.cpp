#include "lodestone/control/goal_seeker.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/json.h"
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
  weak_ = false;
  if (stuck()) still_pulses_ = 0;  // it has been placed elsewhere
  draw_target();
}

geometry::Drive GoalSeeker::act(const task::Observation& observation) {
  if (!observation.last_action.isZero(0.0) && !weak_) {
    const bool moved = observation.last_displacement_m.norm() >= config_.stuck_threshold_m;
    still_pulses_ = moved ? 0 : still_pulses_ + 1;
  }
  const double distance_m = (observation.pose.position_m() - target_m_).norm();
  if (distance_m < config_.reached_m || steps_ >= config_.max_pulses_per_target) draw_target();
  ++steps_;
  task::Observation seen = observation;
  seen.target_m = target_m_;
  const geometry::Drive action = inner_->act(seen);
  const geometry::Drive noise =
      geometry::drawn_drive(static_cast<int>(action.size()), [this] { return random_.normal(); });
  weak_ = config_.weak_fraction > 0.0 && random_.uniform() < config_.weak_fraction;
  if (weak_)
    return noise * (std::pow(config_.weakest_drive, random_.uniform()) / noise.cwiseAbs().maxCoeff());
  return geometry::saturated(action + config_.noise * noise);
}

std::string GoalSeeker::save() const {
  return common::Json{{"random", random_.save()}, {"still_pulses", still_pulses_}}.dump();
}

void GoalSeeker::restore(const std::string& state) {
  const common::Json json = common::parse_json(state, "state of the exploring policy");
  try {
    random_.restore(json.at("random").get<std::string>());
    still_pulses_ = json.at("still_pulses").get<std::int64_t>();
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("state of the exploring policy is malformed: ") + error.what());
  }
}

}  // namespace lodestone::control
