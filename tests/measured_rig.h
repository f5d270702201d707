#pragma once

#include "lodestone/common/random.h"
#include "lodestone/physics/field_fit.h"
#include "lodestone/physics/standing_coil.h"
#include "other_rigs.h"

namespace lodestone::tests {

/// Six bipolar coils around and below a small dish, and 40 uT of the earth's field along x.
inline physics::RigDescription small_ring_rig() {
  physics::RigDescription rig = ring_rig(6, 0.03, true);
  rig.dish.radius_m = 0.02;
  rig.needle.length_m = 0.010;
  rig.needle.chain_m = 0.009;
  return rig;
}

/// The same as a magnetometer without noise sees it, in a box of 25 mm to each side and 10 mm up and down.
inline const physics::FieldFit& measured_small_ring() {
  static const physics::FieldFit fit = [] {
    const physics::RigDescription rig = small_ring_rig();
    common::RandomStream random(5, "samples of a small ring");
    physics::FieldSamples samples;
    samples.coils = rig.coils.count();
    for (int i = 0; i < 600; ++i) {
      const Eigen::Vector3d point_m(random.uniform(-0.025, 0.025), random.uniform(-0.025, 0.025),
                                    random.uniform(-0.01, 0.01));
      Eigen::VectorXd current_A(6);
      Eigen::Vector3d field_T(40e-6, 0.0, 0.0);
      for (Eigen::Index coil = 0; coil < 6; ++coil) {
        current_A[coil] = random.uniform(-5.0, 5.0);
        const auto listed = static_cast<std::size_t>(coil);
        field_T += current_A[coil] * physics::StandingCoil(rig.coils.each[listed]).per_ampere(point_m);
      }
      samples.position_m.push_back(point_m);
      samples.current_A.push_back(current_A);
      samples.field_T.push_back(field_T);
    }
    return physics::fit_field(samples);
  }();
  return fit;
}

/// The rig whose coils are known by those samples only.
inline physics::RigDescription measured_small_ring_rig() {
  physics::RigDescription rig = small_ring_rig();
  rig.coils = measured_small_ring().field.applied_to(rig.coils);
  return rig;
}

}  // namespace lodestone::tests
