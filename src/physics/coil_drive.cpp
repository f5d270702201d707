#include "lodestone/physics/coil_drive.h"

#include <algorithm>
#include <cmath>

namespace lodestone::physics {

PerCoil opposed_pairs_A(const geometry::Vector2& axis_drive_A) {
  return {std::max(axis_drive_A.x(), 0.0), std::max(-axis_drive_A.x(), 0.0), std::max(axis_drive_A.y(), 0.0),
          std::max(-axis_drive_A.y(), 0.0)};
}

CoilDrive::CoilDrive(const RigDescription& rig)
    : coils_(rig.coils.count()), full_drive_A_(rig.coils.max_current_A) {
  if (rig.drive.kind == DriveKind::kOpposedPairs) return;
  field_ = FieldAllocation::shared(rig);
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    largest_A_[coil] = rig.coils.largest_A(coil);
    smallest_A_[coil] = rig.coils.smallest_A(coil);
  }
}

PerCoil CoilDrive::current_A(const geometry::Vector2& drive_A, const geometry::Vector2& position_m) const {
  if (field_ == nullptr) return opposed_pairs_A(drive_A);
  const double size_A = drive_A.norm();
  if (size_A == 0.0) return PerCoil(coils_);
  PerCoil current_A = field_->current_A(std::atan2(drive_A.y(), drive_A.x()), position_m);
  double share = size_A / full_drive_A_;
  for (std::size_t coil = 0; coil < coils_; ++coil) {
    const double most_A = current_A[coil] < 0.0 ? smallest_A_[coil] : largest_A_[coil];
    if (current_A[coil] != 0.0) share = std::min(share, most_A / current_A[coil]);
  }
  for (double& one_A : current_A) one_A *= share;
  return current_A;
}

}  // namespace lodestone::physics
