#include "lodestone/control/either_way.h"

#include <cmath>
#include <memory>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {

namespace {
constexpr double kAgree_rad = 30.0 * geometry::kRadPerDeg;
}

std::optional<geometry::Drive> act_either_way(const Controller& controller,
                                              const task::Observation& observation,
                                              const task::ActionConfig& action) {
  const std::unique_ptr<Controller> as_seen = controller.clone();
  const std::unique_ptr<Controller> as_turned = controller.clone();
  if (as_seen == nullptr || as_turned == nullptr) return std::nullopt;
  task::Observation turned = observation;
  turned.pose.heading_rad = geometry::wrap_angle(observation.pose.heading_rad + geometry::kPi);
  const geometry::Drive one = as_seen->act(observation);
  const geometry::Drive other = as_turned->act(turned);
  const geometry::Drive one_A = task::drive_of(one, action);
  const geometry::Drive other_A = task::drive_of(other, action);
  const double sizes = one_A.norm() * other_A.norm();
  if (!(sizes > 0.0) || one_A.dot(other_A) < std::cos(kAgree_rad) * sizes) return std::nullopt;
  return one_A.norm() <= other_A.norm() ? one : other;
}

}  // namespace lodestone::control
