#pragma once

#include <Eigen/Core>

namespace lodestone::physics {

/// Gradients of solid harmonics, [3, harmonic_count(degree)]: the fields that can stand where there is no
/// source.
using HarmonicGradients = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// How many there are of degree 1 to `degree`; those of lower degrees come first.
constexpr Eigen::Index harmonic_count(int degree) { return degree * (degree + 2); }

/// Gradients of the real regular solid harmonics r^l P_l^m(cos theta) {cos, sin}(m phi) / (l + m)! of degree
/// 1 to `degree` at a point, by their recursions (Epton and Dembart, SIAM J. Sci. Comput. 16, 1995). Every
/// column is free of curl and divergence. Throws LogicFault when the degree is below 1.
HarmonicGradients harmonic_gradients(int degree, const Eigen::Vector3d& point);

}  // namespace lodestone::physics
