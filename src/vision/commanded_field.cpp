#include "lodestone/vision/commanded_field.h"

#include <cmath>

namespace lodestone::vision {

namespace {
constexpr double kSpacing_m = 2e-3;  // a direction needs no finer table
}  // namespace

CommandedField::CommandedField(const physics::RigDescription& rig)
    : dish_radius_m_(rig.dish.radius_m),
      coils_(physics::make_field_table(rig.coils.geometry, rig.dish.radius_m, 0.0, kSpacing_m)) {}

std::optional<double> CommandedField::direction_rad(const physics::Currents& current_A,
                                                    const geometry::Vector2& at_m) const {
  const double distance_m = at_m.norm();
  const geometry::Vector2 inside_m =
      distance_m > dish_radius_m_ ? at_m * (dish_radius_m_ / distance_m) : at_m;
  const geometry::Vector2 field_T = coils_.field_T(current_A, inside_m);
  if (field_T.isZero(0.0)) return std::nullopt;
  return std::atan2(field_T.y(), field_T.x());
}

}  // namespace lodestone::vision
