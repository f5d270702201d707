#pragma once

#include <functional>
#include <vector>

#include "lodestone/physics/dipole_coil.h"

namespace lodestone::control {

/// Field of the four coils as point dipoles, as seen by classical controllers: in terms of two signed axis
/// drives.
class DipoleField {
 public:
  explicit DipoleField(const physics::CoilGeometry& coil);

  /// Field (T) and gradient (T/m) of axis drives (A) at a point of the dish frame.
  physics::FieldGradient at(const geometry::Vector2& axis_drive_A, const geometry::Vector2& position_m) const;

 private:
  std::vector<physics::DipoleCoil> coils_;
};

/// The axis drive of size 1 whose effect (a field, a force) points along `direction`, or as nearly as any
/// does.
geometry::Vector2 unit_drive_along(const geometry::Vector2& direction,
                                   const std::function<geometry::Vector2(const geometry::Vector2&)>& effect);

}  // namespace lodestone::control
