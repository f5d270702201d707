#pragma once

#include <Eigen/Core>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_description.h"
#include "lodestone/physics/finite_coil.h"

namespace lodestone::physics {

/// The exact field of a coil that stands anywhere.
class StandingCoil {
 public:
  /// Throws ConfigError when the description is none of a coil.
  explicit StandingCoil(const CoilDescription& coil);

  /// T/A at a point of the dish frame (m), outside the winding.
  Eigen::Vector3d per_ampere(const Eigen::Vector3d& point_m) const;
  /// The same at a point of the needle's plane; in the winding or close to it, where the field is none of a
  /// coil seen from outside, that of the first point towards the dish centre that is not.
  Eigen::Vector3d beside_winding_per_ampere(geometry::Vector2 point_m) const;

 private:
  CoilDescription coil_;
  FiniteCoil exact_;
  Eigen::Vector3d middle_m_;
  Eigen::Vector3d axis_;
};

}  // namespace lodestone::physics
