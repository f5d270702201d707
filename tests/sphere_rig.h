#pragma once

#include "lodestone/physics/rig_description.h"

namespace lodestone::tests {

/// What lies in the dish of configs/rigs/sphere.json.
inline physics::NeedleConfig sphere() {
  physics::NeedleConfig needle;
  needle.shape = physics::NeedleShape::kSphere;
  needle.length_m = needle.diameter_m = 3e-3;
  needle.chain_m = 1.5e-3;
  needle.moment_A_m2 = 2.74e-3;
  needle.mass_kg = 117.5e-6;
  needle.net_weight_N = 1.008e-3;
  needle.inertia_kg_m2 = 1.06e-10;
  return needle;
}

/// The paper's coils and dish with it.
inline physics::RigDescription sphere_rig() {
  physics::RigDescription rig;
  rig.needle = sphere();
  return rig;
}

}  // namespace lodestone::tests
