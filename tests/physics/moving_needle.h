#pragma once

#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/field_table.h"
#include "lodestone/physics/needle_motion.h"

namespace lodestone::tests {

/// The field of the paper's coils over its dish.
inline const physics::CoilArray& paper_coils() {
  static const physics::CoilArray array(physics::make_field_table(physics::CoilGeometry{}, 0.0425));
  return array;
}

/// The same friction everywhere.
inline physics::FrictionConfig smooth_friction() {
  physics::FrictionConfig friction;
  friction.map_sigma = 0.0;
  return friction;
}

inline double kinetic_energy(const physics::NeedleConfig& needle, const physics::NeedleState& state) {
  return 0.5 * needle.mass_kg *
             (state.velocity_x_m_s * state.velocity_x_m_s + state.velocity_y_m_s * state.velocity_y_m_s) +
         0.5 * needle.inertia_kg_m2 * state.spin_rad_s * state.spin_rad_s;
}

/// At the centre, along +x.
inline physics::NeedleState moving(double vx_m_s, double vy_m_s, double spin_rad_s) {
  physics::NeedleState state;
  state.velocity_x_m_s = vx_m_s;
  state.velocity_y_m_s = vy_m_s;
  state.spin_rad_s = spin_rad_s;
  state.stuck = false;
  return state;
}

}  // namespace lodestone::tests
