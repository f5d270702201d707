#include "lodestone/control/decorators.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone::control {

namespace {
constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;
}

AdaptiveGain::AdaptiveGain(std::unique_ptr<Controller> inner, const DecoratorConfig& config)
    : inner_(std::move(inner)), config_(config) {}

void AdaptiveGain::reset() {
  inner_->reset();
  gain_ = 1.0;
  acted_ = false;
}

geometry::Vector2 AdaptiveGain::act(const task::Observation& observation) {
  // A rest (hold, or no valid pose) in between says nothing about stalling.
  const bool driven = acted_ && !observation.last_action.isZero();
  if (driven) {
    const double turn_deg =
        kDegPerRad * std::abs(geometry::wrap_angle(observation.pose.heading_rad - last_pose_.heading_rad));
    const bool moved = observation.last_displacement_m.norm() >= config_.stall_threshold_m ||
                       turn_deg >= config_.stall_threshold_deg;
    gain_ = moved ? 1.0 : std::min(gain_ * config_.stall_gain, config_.stall_gain_max);
  }
  acted_ = true;
  last_pose_ = observation.pose;
  const geometry::Vector2 action = gain_ * inner_->act(observation);
  // Scaled as a whole, so that the direction of the pull survives the limit.
  return action / std::max(1.0, action.cwiseAbs().maxCoeff());
}

geometry::Vector2 Hold::act(const task::Observation& observation) {
  if ((observation.target_m - observation.pose.position_m()).norm() <= radius_m_)
    return geometry::Vector2::Zero();
  return inner_->act(observation);
}

std::unique_ptr<Controller> decorate(std::unique_ptr<Controller> controller, const DecoratorConfig& config) {
  if (config.stall_gain > 1.0) controller = std::make_unique<AdaptiveGain>(std::move(controller), config);
  if (config.hold_radius_m > 0.0)
    controller = std::make_unique<Hold>(std::move(controller), config.hold_radius_m);
  return controller;
}

}  // namespace lodestone::control
