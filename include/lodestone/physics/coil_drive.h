#pragma once

#include <cstddef>
#include <memory>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/field_allocation.h"
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
  /// Throws ConfigError where the coils cannot make the field of DriveKind::kField (FieldAllocation).
  explicit CoilDrive(const RigDescription& rig);

  std::size_t coils() const { return coils_; }
  /// For a needle at a point of the dish frame, which matters to DriveKind::kField alone. Within the coils'
  /// limits: a drive that asks for more gives as much as there is, along its direction.
  PerCoil current_A(const geometry::Vector2& drive_A, const geometry::Vector2& position_m) const;

 private:
  std::size_t coils_ = 4;
  std::shared_ptr<const FieldAllocation> field_;  ///< null: opposed pairs
  PerCoil largest_A_, smallest_A_;
  double full_drive_A_ = 0.0;
};

}  // namespace lodestone::physics
