#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// Currents of the coils +x, -x, +y, -y for signed currents of two axes (A): the sign picks the coil, and
/// opposite ones are never on together (section IV-B3).
PerCoil opposed_pairs_A(const geometry::Vector2& axis_drive_A);

/// What a drive in two dimensions, in ampere of the rig's largest current, is for its coils. Proportional:
/// half the drive is half of each current.
class CoilDrive {
 public:
  /// The paper's four coils.
  CoilDrive() = default;
  /// Of DriveKind::kField: for each direction the smallest currents that make a field along it, and along it
  /// the largest pull that every direction can have; where both at once are out of reach, as with four
  /// unipolar coils between their axes, each as nearly as it can. Throws ConfigError where they would be more
  /// than 25 degrees off.
  explicit CoilDrive(const RigDescription& rig);

  std::size_t coils() const { return coils_; }
  /// Within the coils' limits: a drive that asks for more gives as much as there is, along its direction.
  PerCoil current_A(const geometry::Vector2& drive_A) const;
  /// Pull (N) at the dish centre of a drive of the rig's largest current on a needle that lies along it; 0
  /// for opposed pairs.
  double full_pull_N() const { return full_pull_N_; }

 private:
  PerCoil along(double direction_rad) const;

  std::size_t coils_ = 4;
  std::vector<PerCoil> by_direction_A_;  ///< of a full drive, evenly around; empty: opposed pairs
  PerCoil largest_A_, smallest_A_;
  std::vector<std::pair<std::size_t, std::size_t>> apart_;  ///< never on together
  double full_drive_A_ = 0.0;
  double full_pull_N_ = 0.0;
};

}  // namespace lodestone::physics
