#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_description.h"
#include "lodestone/physics/measured_region.h"
#include "lodestone/physics/standing_coil.h"

namespace lodestone::physics {

/// The field of one coil as its rig describes it: the exact one of its winding, or what a magnetometer saw.
class DescribedCoil {
 public:
  /// Throws ConfigError when the description is none of a coil.
  DescribedCoil(const CoilDescription& coil, const MeasuredRegion& measured);

  /// T/A at a point of the dish frame (m), outside the winding. Throws DataError where nobody measured.
  Eigen::Vector3d per_ampere(const Eigen::Vector3d& point_m) const;
  /// The same at a point of the needle's plane, for tables and pictures, which have rims: in the winding as
  /// StandingCoil has it, and beyond what was measured as the harmonics go on.
  Eigen::Vector3d in_plane_per_ampere(const geometry::Vector2& point_m) const;

 private:
  CoilDescription coil_;
  MeasuredRegion measured_;
  std::optional<StandingCoil> winding_;
};

}  // namespace lodestone::physics
