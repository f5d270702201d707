#include "lodestone/physics/four_coils.h"

#include <string>

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

}  // namespace lodestone::physics
