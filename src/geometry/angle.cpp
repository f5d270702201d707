#include "lodestone/geometry/angle.h"

#include <cmath>

namespace lodestone::geometry {

double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);  // in [-pi, pi]
  return wrapped <= -kPi ? kPi : wrapped;
}

}  // namespace lodestone::geometry
