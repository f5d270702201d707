#pragma once

#include <cmath>
#include <string>

#include "lodestone/physics/rig_description.h"

namespace lodestone::tests {

/// The four coils of the paper's rig, listed one by one.
inline physics::RigDescription listed_paper_rig() {
  physics::RigDescription rig;
  for (std::size_t coil = 0; coil < 4; ++coil)
    rig.coils.each.push_back(physics::CoilsDescription{}.coil(coil));
  return rig;
}

/// So many narrow coils evenly around the dish, `below_m` under the needle's plane, their axes towards the
/// middle of the dish.
inline physics::RigDescription ring_rig(int coils, double below_m = 0.0, bool bipolar = false) {
  physics::RigDescription rig;
  rig.drive.kind = physics::DriveKind::kField;
  for (int i = 0; i < coils; ++i) {
    const double angle_rad = 2.0 * 3.14159265358979323846 * i / coils;
    physics::CoilDescription coil;
    coil.name = "c" + std::to_string(i + 1);
    coil.position_m = {0.09 * std::cos(angle_rad), 0.09 * std::sin(angle_rad), -below_m};
    coil.inner_radius_m = 0.010;
    coil.outer_radius_m = 0.028;
    coil.length_m = 0.06;
    coil.bipolar = bipolar;
    rig.coils.each.push_back(coil);
  }
  const auto count = static_cast<std::size_t>(coils);
  rig.coils.resistance_20C_ohm.assign(count, 1.0);
  rig.coils.inductance_H.assign(count, 5e-3);
  rig.coils.polarity.assign(count, 1);
  return rig;
}

}  // namespace lodestone::tests
