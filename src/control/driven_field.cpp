#include "lodestone/control/driven_field.h"

#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::control {

DrivenField::DrivenField(const physics::RigDescription& rig) : drive_(rig), field_(rig) {}

physics::FieldGradient DrivenField::at(const geometry::Drive& drive_A,
                                       const geometry::Vector2& position_m) const {
  return field_.at(drive_.current_A(drive_A, position_m), position_m);
}

geometry::Vector2 unit_drive_along(const geometry::Vector2& direction,
                                   const std::function<geometry::Vector2(const geometry::Vector2&)>& effect) {
  constexpr int kCoarse = 72;
  double best_angle = 0.0;
  double best_cosine = -2.0;
  const auto try_angle = [&](double angle) {
    const geometry::Vector2 vector = effect({std::cos(angle), std::sin(angle)});
    const double size = vector.norm();
    const double cosine = size > 0.0 ? vector.dot(direction) / size : -1.0;
    if (cosine > best_cosine) {
      best_cosine = cosine;
      best_angle = angle;
    }
  };
  for (int i = 0; i < kCoarse; ++i) try_angle(2.0 * geometry::kPi * i / kCoarse);
  for (double step = 2.0 * geometry::kPi / kCoarse / 2.0; step > 1e-4; step /= 2.0) {
    const double centre = best_angle;
    try_angle(centre - step);
    try_angle(centre + step);
  }
  return {std::cos(best_angle), std::sin(best_angle)};
}

}  // namespace lodestone::control
