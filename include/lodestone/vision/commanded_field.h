#pragma once

#include <optional>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::vision {

/// The field that the coils were asked for, as far as the rig is described. Places outside the dish count as
/// the nearest one inside.
class CommandedField {
 public:
  explicit CommandedField(const physics::RigDescription& rig);

  /// Where the field points at a place; nothing where there is no field.
  std::optional<double> direction_rad(const physics::PerCoil& current_A, const geometry::Vector2& at_m) const;
  /// Pull (N) on a needle that has turned into the field: its moment times the gradient of the field's
  /// magnitude.
  geometry::Vector2 pull_N(const physics::PerCoil& current_A, const geometry::Vector2& at_m) const;

 private:
  geometry::Vector2 field_T(const physics::PerCoil& current_A, const geometry::Vector2& at_m) const;

  double dish_radius_m_;
  double moment_A_m2_;
  physics::CoilArray coils_;
};

}  // namespace lodestone::vision
