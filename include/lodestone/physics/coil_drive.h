#pragma once

#include <cstddef>
#include <memory>

#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/apart_coils.h"
#include "lodestone/physics/field_allocation.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// Currents of the coils +x, -x, +y, -y for signed currents of two axes (A): the sign picks the coil, and
/// opposite ones are never on together (section IV-B3).
PerCoil opposed_pairs_A(const geometry::Drive& axis_drive_A);

/// What a drive, in ampere of the rig's largest current, is for its coils. Proportional: half the drive is
/// half of each current.
class CoilDrive {
 public:
  /// The paper's four coils.
  CoilDrive() = default;
  /// Throws ConfigError where the coils cannot make the field of DriveKind::kField (FieldAllocation).
  explicit CoilDrive(const RigDescription& rig);

  std::size_t coils() const { return coils_; }
  /// Numbers of a drive.
  int size() const { return size_; }
  /// The least that a number of a drive can be, as a share of the largest: -1, or 0 where it is the current
  /// of a coil that takes one sign only.
  double least(int number) const;

  /// For a needle at a point of the dish frame, which matters to DriveKind::kField alone. Within the coils'
  /// limits: a drive that asks for more gives as much as there is, along its direction; of independent coils
  /// each gives as much as it can.
  PerCoil current_A(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const;

  /// The drive that classical controllers mean by two numbers: a field along their direction and a pull along
  /// it, as strong as they are, in any unit. What opposed pairs and a field of two numbers are anyway; for
  /// other kinds as nearly as the coils can.
  geometry::Drive along(const geometry::Vector2& direction, const geometry::Vector2& position_m) const;
  /// A drive with field and pull turned counterclockwise; that of independent coils, which has no direction
  /// of its own, as it is.
  geometry::Drive turned(const geometry::Drive& drive, double angle_rad) const;

 private:
  PerCoil independent_A(const geometry::Drive& drive_A) const;
  PerCoil field_A(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const;

  DriveKind kind_ = DriveKind::kOpposedPairs;
  int size_ = 2;
  std::size_t coils_ = 4;
  std::shared_ptr<const FieldAllocation> field_;  ///< null: opposed pairs
  ApartCoils apart_;
  PerCoil largest_A_, smallest_A_;
  double full_drive_A_ = 0.0;
};

}  // namespace lodestone::physics
