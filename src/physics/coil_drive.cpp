#include "lodestone/physics/coil_drive.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "lodestone/common/error.h"

namespace lodestone::physics {

PerCoil opposed_pairs_A(const geometry::Drive& axis_drive_A) {
  const double x_A = axis_drive_A[0], y_A = axis_drive_A[1];
  return {std::max(x_A, 0.0), std::max(-x_A, 0.0), std::max(y_A, 0.0), std::max(-y_A, 0.0)};
}

CoilDrive::CoilDrive(const RigDescription& rig)
    : kind_(rig.drive.kind),
      size_(rig.drive_size()),
      coils_(rig.coils.count()),
      full_drive_A_(rig.coils.max_current_A) {
  if (kind_ == DriveKind::kOpposedPairs) return;
  field_ = FieldAllocation::shared(rig);
  if (kind_ == DriveKind::kIndependent) apart_ = ApartCoils(rig.coils);
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    largest_A_[coil] = rig.coils.largest_A(coil);
    smallest_A_[coil] = rig.coils.smallest_A(coil);
  }
}

double CoilDrive::least(int number) const {
  return kind_ == DriveKind::kIndependent && smallest_A_[static_cast<std::size_t>(number)] >= 0.0 ? 0.0
                                                                                                  : -1.0;
}

PerCoil CoilDrive::current_A(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const {
  LODESTONE_CHECK(drive_A.size() == size_, "a drive of " + std::to_string(size_) + " numbers, not of " +
                                               std::to_string(drive_A.size()));
  switch (kind_) {
    case DriveKind::kOpposedPairs:
      return opposed_pairs_A(drive_A);
    case DriveKind::kIndependent:
      return independent_A(drive_A);
    case DriveKind::kField:
      break;
  }
  return field_A(drive_A, position_m);
}

PerCoil CoilDrive::independent_A(const geometry::Drive& drive_A) const {
  PerCoil current_A(coils_);
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    const double share = drive_A[static_cast<Eigen::Index>(coil)] / full_drive_A_;
    current_A[coil] = std::clamp(share * largest_A_[coil], smallest_A_[coil], largest_A_[coil]);
  }
  apart_.keep(current_A);
  return current_A;
}

PerCoil CoilDrive::field_A(const geometry::Drive& drive_A, const geometry::Vector2& position_m) const {
  double size_A = 0.0;
  PerCoil current_A;
  if (size_ == 2) {
    size_A = drive_A.norm();
    if (size_A == 0.0) return PerCoil(coils_);
    current_A = field_->current_A(std::atan2(drive_A[1], drive_A[0]), position_m);
  } else {
    const geometry::Vector2 turning_A = drive_A.head<2>();
    const geometry::Vector2 pull_A = size_ == 3 ? geometry::Vector2(drive_A[2] * turning_A.normalized())
                                                : geometry::Vector2(drive_A.tail<2>());
    size_A = std::max(turning_A.norm(), pull_A.norm());
    if (size_A == 0.0) return PerCoil(coils_);
    current_A = field_->current_A(turning_A / size_A, pull_A / size_A, position_m);
  }
  double share = size_A / full_drive_A_;
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    const double most_A = current_A[coil] < 0.0 ? smallest_A_[coil] : largest_A_[coil];
    if (current_A[coil] != 0.0) share = std::min(share, most_A / current_A[coil]);
  }
  for (std::size_t coil = 0; coil < coils_; ++coil)  // rounded, it may be a bit above
    current_A[coil] = std::clamp(share * current_A[coil], smallest_A_[coil], largest_A_[coil]);
  return current_A;
}

geometry::Drive CoilDrive::along(const geometry::Vector2& direction,
                                 const geometry::Vector2& position_m) const {
  geometry::Drive drive = geometry::Drive::Zero(size_);
  if (kind_ != DriveKind::kIndependent) {
    drive.head<2>() = direction;
    if (size_ == 3) drive[2] = direction.norm();
    if (size_ == 4) drive.tail<2>() = direction;
    return drive;
  }
  const double size = direction.norm();
  if (size == 0.0) return drive;
  const PerCoil current_A = field_->current_A(std::atan2(direction.y(), direction.x()), position_m);
  for (std::size_t coil = 0; coil < coils_; ++coil)
    if (largest_A_[coil] > 0.0)
      drive[static_cast<Eigen::Index>(coil)] = size * current_A[coil] / largest_A_[coil];
  return drive;
}

geometry::Drive CoilDrive::turned(const geometry::Drive& drive, double angle_rad) const {
  geometry::Drive out = drive;
  if (kind_ == DriveKind::kIndependent) return out;
  const Eigen::Rotation2Dd turn(angle_rad);
  out.head<2>() = turn * geometry::Vector2(drive.head<2>());
  if (size_ == 4) out.tail<2>() = turn * geometry::Vector2(drive.tail<2>());
  return out;
}

}  // namespace lodestone::physics
