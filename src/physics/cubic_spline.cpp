#include "cubic_spline.h"

namespace lodestone::physics {

void to_spline(double* line, int count, int stride, std::vector<double>& scratch) {
  scratch.resize(static_cast<std::size_t>(count));
  const auto value = [&](int i) -> double& { return line[static_cast<std::ptrdiff_t>(i) * stride]; };
  scratch[0] = 0.0;
  for (int i = 1; i < count - 1; ++i) {
    const double pivot = 4.0 - scratch[i - 1];
    scratch[i] = 1.0 / pivot;
    value(i) = (6.0 * value(i) - value(i - 1)) / pivot;
  }
  for (int i = count - 2; i >= 1; --i) value(i) -= scratch[i] * value(i + 1);
}

}  // namespace lodestone::physics
