#pragma once

#include <optional>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::vision {

/// The direction of the field that the coils were asked for, as far as the rig is described.
class CommandedField {
 public:
  explicit CommandedField(const physics::RigDescription& rig);

  /// Where the field points at a place in the dish; a place outside counts as the nearest one inside. Nothing
  /// where there is no field.
  std::optional<double> direction_rad(const physics::Currents& current_A,
                                      const geometry::Vector2& at_m) const;

 private:
  double dish_radius_m_;
  physics::CoilArray coils_;
};

}  // namespace lodestone::vision
