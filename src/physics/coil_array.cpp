#include "lodestone/physics/coil_array.h"

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

CoilArray::CoilArray(std::shared_ptr<const FieldTable> table) : table_(std::move(table)) {
  LODESTONE_CHECK(table_ != nullptr, "a field table is needed");
}

geometry::Vector2 CoilArray::field_T(const Currents& current_A, const geometry::Vector2& point_m) const {
  // Below a microampere a coil moves nothing: its pull is a millionth of the break-away force.
  constexpr double kNegligibleA = 1e-6;
  geometry::Vector2 sum = geometry::Vector2::Zero();
  for (int coil = 0; coil < kCoils; ++coil) {
    const double current = current_A[static_cast<std::size_t>(coil)];
    if (std::abs(current) < kNegligibleA) continue;
    sum += current * from_coil_frame(coil, table_->per_ampere(to_coil_frame(coil, point_m)));
  }
  return sum;
}

}  // namespace lodestone::physics
