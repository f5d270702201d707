#include "lodestone/physics/coil_array.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/physics/four_coils.h"

namespace lodestone::physics {
namespace {

// Below a microampere a coil moves nothing: its pull is a millionth of the break-away force.
constexpr double kNegligible_A = 1e-6;

}  // namespace

CoilArray::CoilArray(std::shared_ptr<const CoilFields> fields, std::vector<CoilPlacement> placements)
    : fields_(std::move(fields)), placements_(std::move(placements)) {
  LODESTONE_CHECK(fields_ != nullptr, "the coils' fields are needed");
  LODESTONE_CHECK(placements_.empty() || placements_.size() == fields_->coils(), "a placement for each coil");
}

CoilArray::CoilArray(std::shared_ptr<const FieldTable> table, std::vector<CoilPlacement> placements)
    : CoilArray(std::make_shared<const CoilFields>(std::move(table)), std::move(placements)) {}

/// The point as the coil would see it from where it should stand, and its field there turned as it is.
Eigen::Vector3d CoilArray::per_ampere(std::size_t coil, const geometry::Vector2& point_m) const {
  if (placements_.empty()) return fields_->per_ampere(coil, point_m);
  const CoilPlacement& placement = placements_[coil];
  const Eigen::Rotation2Dd tilt(placement.tilt_rad);
  const geometry::Vector2 middle_m = fields_->middle_m(coil).head<2>();
  if (planar()) {  // in the coil's own frame, in which all four are one
    const int index = static_cast<int>(coil);
    const geometry::Vector2 own_middle_m = to_coil_frame(index, middle_m);
    const geometry::Vector2 local_m = to_coil_frame(index, point_m - placement.offset_m);
    const geometry::Vector2 untilted_m = own_middle_m + tilt.inverse() * (local_m - own_middle_m);
    const geometry::Vector2 field =
        placement.gain * from_coil_frame(index, tilt * fields_->table().per_ampere(untilted_m));
    return {field.x(), field.y(), 0.0};
  }
  const geometry::Vector2 untilted_m = middle_m + tilt.inverse() * (point_m - placement.offset_m - middle_m);
  Eigen::Vector3d field = fields_->per_ampere(coil, untilted_m);
  field.head<2>() = tilt * geometry::Vector2(field.head<2>());
  return placement.gain * field;
}

geometry::Vector2 CoilArray::field_T(const PerCoil& current_A, const geometry::Vector2& point_m) const {
  if (!planar() || !placements_.empty()) return spatial_field_T(current_A, point_m).head<2>();
  geometry::Vector2 sum = geometry::Vector2::Zero();
  for (std::size_t coil = 0; coil < fields_->coils(); ++coil)
    if (std::abs(current_A[coil]) >= kNegligible_A) sum += current_A[coil] * fields_->in_plane(coil, point_m);
  return sum;
}

Eigen::Vector3d CoilArray::spatial_field_T(const PerCoil& current_A, const geometry::Vector2& point_m) const {
  Eigen::Vector3d sum = fields_->background_T(point_m);
  for (std::size_t coil = 0; coil < fields_->coils(); ++coil)
    if (std::abs(current_A[coil]) >= kNegligible_A) sum += current_A[coil] * per_ampere(coil, point_m);
  return sum;
}

}  // namespace lodestone::physics
