#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include "lodestone/physics/coils_description.h"

namespace lodestone::tests {

/// So many unipolar coils of 1.9 ohm on a ring around the dish, named by their number.
inline physics::CoilsDescription ring_of(std::size_t coils) {
  physics::CoilsDescription ring;
  for (std::size_t i = 0; i < coils; ++i) {
    const double angle_rad =
        2.0 * 3.14159265358979323846 * static_cast<double>(i) / static_cast<double>(coils);
    physics::CoilDescription coil;
    coil.name = "c" + std::to_string(i);
    coil.position_m = {0.2 * std::cos(angle_rad), 0.2 * std::sin(angle_rad), 0.0};
    ring.each.push_back(coil);
  }
  ring.resistance_20C_ohm.assign(coils, 1.9);
  ring.inductance_H.assign(coils, 17.6e-3);
  ring.polarity.assign(coils, 1);
  return ring;
}

}  // namespace lodestone::tests
