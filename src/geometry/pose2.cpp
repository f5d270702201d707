#include "lodestone/geometry/pose2.h"

#include <cmath>

namespace lodestone::geometry {

double wrap_angle(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * M_PI);  // in [-pi, pi]
  return wrapped <= -M_PI ? M_PI : wrapped;
}

}  // namespace lodestone::geometry
