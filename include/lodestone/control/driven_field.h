#pragma once

#include <functional>
#include <vector>

#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/modelled_field.h"

namespace lodestone::control {

/// The field as classical controllers see it (of the paper's rig that of point dipoles), in terms of what
/// drives the coils.
class DrivenField {
 public:
  explicit DrivenField(const physics::RigDescription& rig);

  /// Field (T) and gradient (T/m) of a drive (A) at a point of the dish frame.
  physics::FieldGradient at(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const;
  /// The rig's drive for two numbers: as physics::CoilDrive.
  geometry::Drive along(const geometry::Vector2& direction, const geometry::Vector2& position_m) const {
    return drive_.along(direction, position_m);
  }

 private:
  physics::CoilDrive drive_;
  physics::ModelledField field_;
};

/// The two numbers of size 1 (physics::CoilDrive::along) whose effect (a field, a force) points along
/// `direction`, or as nearly as any does.
geometry::Vector2 unit_drive_along(const geometry::Vector2& direction,
                                   const std::function<geometry::Vector2(const geometry::Vector2&)>& effect);

}  // namespace lodestone::control
