#include "lodestone/physics/core_saturation.h"

#include <cmath>

namespace lodestone::physics {

double unsaturated_A(double current_A, double core_share, double saturation_A) {
  if (core_share == 0.0) return current_A;
  return (1.0 - core_share) * current_A + core_share * saturation_A * std::tanh(current_A / saturation_A);
}

}  // namespace lodestone::physics
