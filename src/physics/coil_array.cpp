#include "lodestone/physics/coil_array.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::physics {

geometry::Vector2 to_coil_frame(int coil, const geometry::Vector2& vector) {
  switch (coil) {
    case 0:
      return vector;
    case 1:
      return -vector;
    case 2:
      return {vector.y(), -vector.x()};
    case 3:
      return {-vector.y(), vector.x()};
    default:
      break;
  }
  throw common::LogicFault("coil must be 0 to 3, got " + std::to_string(coil));
}

geometry::Vector2 from_coil_frame(int coil, const geometry::Vector2& vector) {
  // The rotation of +y is the inverse of that of -y; those of +x and -x are their own inverses.
  return to_coil_frame(coil < 2 ? coil : 5 - coil, vector);
}

geometry::Vector2 coil_direction(int coil) { return from_coil_frame(coil, {1.0, 0.0}); }

CoilArray::CoilArray(std::shared_ptr<const FieldTable> table, std::vector<CoilPlacement> placements)
    : table_(std::move(table)), placements_(std::move(placements)) {
  LODESTONE_CHECK(table_ != nullptr, "a field table is needed");
  LODESTONE_CHECK(placements_.empty() || placements_.size() == kCoils, "a placement for each coil");
}

geometry::Vector2 CoilArray::displaced_per_ampere(int coil, const geometry::Vector2& point_m) const {
  const CoilPlacement& placement = placements_[static_cast<std::size_t>(coil)];
  const geometry::Vector2 middle_m(table_->geometry().centre_distance_m, 0.0);
  const Eigen::Rotation2Dd tilt(placement.tilt_rad);
  const geometry::Vector2 local_m = to_coil_frame(coil, point_m - placement.offset_m);
  const geometry::Vector2 untilted_m = middle_m + tilt.inverse() * (local_m - middle_m);
  return placement.gain * from_coil_frame(coil, tilt * table_->per_ampere(untilted_m));
}

geometry::Vector2 CoilArray::field_T(const Currents& current_A, const geometry::Vector2& point_m) const {
  // Below a microampere a coil moves nothing: its pull is a millionth of the break-away force.
  constexpr double kNegligibleA = 1e-6;
  geometry::Vector2 sum = geometry::Vector2::Zero();
  for (int coil = 0; coil < kCoils; ++coil) {
    const double current = current_A[static_cast<std::size_t>(coil)];
    if (std::abs(current) < kNegligibleA) continue;
    sum += current * (placements_.empty()
                          ? from_coil_frame(coil, table_->per_ampere(to_coil_frame(coil, point_m)))
                          : displaced_per_ampere(coil, point_m));
  }
  return sum;
}

}  // namespace lodestone::physics
