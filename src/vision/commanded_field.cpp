#include "lodestone/vision/commanded_field.h"

#include <cmath>
#include <memory>

namespace lodestone::vision {

namespace {
constexpr double kSpacing_m = 2e-3;  // a direction needs no finer table
}  // namespace

CommandedField::CommandedField(const physics::RigDescription& rig)
    : dish_radius_m_(rig.dish.radius_m),
      moment_A_m2_(rig.needle.moment_A_m2),
      coils_(physics::CoilFields::shared(rig.coils, rig.dish.radius_m, 0.0, kSpacing_m)) {}

geometry::Vector2 CommandedField::field_T(const physics::PerCoil& current_A,
                                          const geometry::Vector2& at_m) const {
  const double distance_m = at_m.norm();
  return coils_.field_T(current_A, distance_m > dish_radius_m_
                                       ? geometry::Vector2(at_m * (dish_radius_m_ / distance_m))
                                       : at_m);
}

std::optional<double> CommandedField::direction_rad(const physics::PerCoil& current_A,
                                                    const geometry::Vector2& at_m) const {
  const geometry::Vector2 here_T = field_T(current_A, at_m);
  if (here_T.isZero(0.0)) return std::nullopt;
  return std::atan2(here_T.y(), here_T.x());
}

geometry::Vector2 CommandedField::pull_N(const physics::PerCoil& current_A,
                                         const geometry::Vector2& at_m) const {
  const double distance_m = at_m.norm();
  const double inside_m = dish_radius_m_ - kSpacing_m;
  const geometry::Vector2 centre_m =
      distance_m > inside_m ? geometry::Vector2(at_m * (inside_m / distance_m)) : at_m;
  const auto slope = [&](const geometry::Vector2& step_m) {
    return (field_T(current_A, centre_m + step_m).norm() - field_T(current_A, centre_m - step_m).norm()) /
           (2.0 * kSpacing_m);
  };
  return moment_A_m2_ * geometry::Vector2(slope({kSpacing_m, 0.0}), slope({0.0, kSpacing_m}));
}

}  // namespace lodestone::vision
