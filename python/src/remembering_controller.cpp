#include "remembering_controller.h"

#include "lodestone/geometry/saturation.h"

namespace lodestone::python {

void RememberingController::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  controller_->reset();
  position_m_.reset();
  action_.setZero();
}

geometry::Drive RememberingController::act(const geometry::Pose2& pose, const geometry::Vector2& target_m,
                                           std::optional<double> target_heading_rad) {
  const std::lock_guard<std::mutex> lock(mutex_);
  task::Observation observation;
  observation.pose = pose;
  observation.target_m = target_m;
  observation.target_heading_rad = target_heading_rad;
  observation.last_action = action_;
  if (position_m_) observation.last_displacement_m = pose.position_m() - *position_m_;
  action_ = geometry::saturated(controller_->act(observation));
  position_m_ = pose.position_m();
  return action_;
}

}  // namespace lodestone::python
