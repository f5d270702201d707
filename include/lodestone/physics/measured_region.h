#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace lodestone::physics {

/// The field of coils of which no geometry is known, cored ones for example: what a magnetometer saw as
/// gradients of solid harmonics, a set for each coil and one for what is there without current. Holds inside
/// the box that was sampled (2 % more on each side), and nowhere else: beyond it, harmonics grow without a
/// bound. Linear in the currents, so not for cores that saturate. Also `field.json`.
struct MeasuredField {
  std::int64_t degree = 0;
  std::array<double, 3> centre_m = {};             ///< of the expansions
  double scale_m = 1.0;                            ///< length that they count in
  std::array<double, 3> low_m = {}, high_m = {};   ///< corners of the box
  std::vector<std::vector<double>> coils_T_per_A;  ///< [coils][harmonic_count(degree)]
  std::vector<double> background_T;                ///< [harmonic_count(degree)]

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("degree", degree);
    v.field("centre_m", centre_m);
    v.field("scale_m", scale_m);
    v.field("low_m", low_m);
    v.field("high_m", high_m);
    v.field("coils_T_per_A", coils_T_per_A);
    v.field("background_T", background_T);
  }
  /// Throws DataError when the numbers of coefficients do not fit the degree, or the box is empty.
  void validate() const;

  /// T, at a point (m) for as many currents (A) as there are coils. Throws DataError that names the point
  /// when it lies outside the box.
  Eigen::Vector3d field_T(const Eigen::VectorXd& current_A, const Eigen::Vector3d& point_m) const;
};

}  // namespace lodestone::physics
