#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coils_description.h"

namespace lodestone::physics {

/// Field and its derivatives in the needle's plane.
struct FieldGradient {
  geometry::Vector2 field_T = geometry::Vector2::Zero();
  Eigen::Matrix2d gradient_T_per_m = Eigen::Matrix2d::Zero();  ///< (i, j): dB_i / dx_j; symmetric
};

/// A coil as a point dipole at its centre, moment = current x turns x area (eq. 7). The far field only.
/// Eq. 7 prints -(I - 3 d d^T / d^2) m, with I the unit matrix; so does this.
class DipoleCoil {
 public:
  /// `coil`: 0..3 for +x, -x, +y, -y. Area: mean of pi r^2 over the winding.
  DipoleCoil(const CoilGeometry& geometry, int coil);
  explicit DipoleCoil(const CoilDescription& coil);

  /// Adds the field and gradient of `current_A` at a point of the dish frame.
  void add(double current_A, const geometry::Vector2& point_m, FieldGradient& sum) const;
  double moment_per_ampere_m2() const { return moment_per_ampere_m2_; }

 private:
  Eigen::Vector3d centre_m_;
  Eigen::Vector3d direction_;
  double moment_per_ampere_m2_;
};

/// All of a rig's coils.
std::vector<DipoleCoil> dipole_coils(const CoilsDescription& coils);

}  // namespace lodestone::physics
