#pragma once

#include <cstddef>
#include <vector>

namespace lodestone::physics {

/// Nodes that a table needs beyond its reach: the spline's end condition fades by 0.27 per node.
constexpr int kSplinePadding = 6;

/// Turns samples into cubic B-spline coefficients along one line, in place: solves
/// c[i-1] + 4 c[i] + c[i+1] = 6 f[i] with the natural end c = f.
void to_spline(double* line, int count, int stride, std::vector<double>& scratch);

struct SplineWeights {
  double w[4];
};

/// Of the four coefficients around a place that is `t` of the way from the second to the third.
inline SplineWeights spline_weights(double t) {
  const double s = 1.0 - t;
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {{s * s * s / 6.0, (3.0 * t3 - 6.0 * t2 + 4.0) / 6.0, (-3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0) / 6.0,
           t3 / 6.0}};
}

}  // namespace lodestone::physics
