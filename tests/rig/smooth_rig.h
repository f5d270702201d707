#pragma once

#include <algorithm>
#include <cstring>
#include <memory>

#include "lodestone/common/random.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/rig/virtual_rig.h"
#include "rig/described_rig.h"

namespace lodestone::tests {

inline std::shared_ptr<const physics::CoilFields> shared_fields() {
  static const auto fields = std::make_shared<const physics::CoilFields>(physics::CoilsDescription{},
                                                                         physics::DishConfig{}.radius_m);
  return fields;
}

/// The rig without any scatter.
inline rig::VirtualRigConfig smooth() {
  rig::VirtualRigConfig config = described_rig();
  config.friction.map_sigma = 0.0;
  config.friction.pulse_sigma = 0.0;
  return config;
}

inline bool same_bits(const geometry::Pose2& a, const geometry::Pose2& b) {
  return std::memcmp(&a.x_m, &b.x_m, sizeof(double)) == 0 &&
         std::memcmp(&a.y_m, &b.y_m, sizeof(double)) == 0 &&
         std::memcmp(&a.heading_rad, &b.heading_rad, sizeof(double)) == 0;
}

inline rig::CoilPulse random_pulse(common::RandomStream& random) {
  const double x = random.uniform(-15.0, 15.0), y = random.uniform(-15.0, 15.0);
  return {{std::max(x, 0.0), std::max(-x, 0.0), std::max(y, 0.0), std::max(-y, 0.0)}, 0.1};
}

}  // namespace lodestone::tests
