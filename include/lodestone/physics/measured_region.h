#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace lodestone::physics {

/// Where a magnetometer was, of coils whose field is what it saw: gradients of solid harmonics
/// (CoilDescription::harmonics_T_per_A), as nothing else is known of coils with cores, for example. They hold
/// inside the box that was sampled and nowhere else: beyond it, harmonics grow without a bound.
struct MeasuredRegion {
  std::vector<double> centre_m;       ///< [3]: of the expansions; empty: no coil was measured
  double scale_m = 1.0;               ///< length that they count in
  std::vector<double> low_m, high_m;  ///< [3]: corners of the box
  std::vector<double> background_T;   ///< harmonics of the field without currents; empty: none

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("centre_m", centre_m, "m",
            "[x, y, z] from the middle of the needle's plane: what the harmonics are about; []: no coil was "
            "measured",
            {-1.0, 1.0});
    v.field("scale_m", scale_m, "m", "length that the harmonics count in", {1e-4, 10.0});
    v.field("low_m", low_m, "m", "[x, y, z]: lowest corner of the box that was sampled", {-1.0, 1.0});
    v.field("high_m", high_m, "m", "[x, y, z]: highest corner of that box", {-1.0, 1.0});
    v.field("background_T", background_T, "T",
            "harmonics of the field that is there without currents; []: none", {-1e12, 1e12});
  }
  /// Throws ConfigError when what stands here is no box, or no expansion about its inside.
  void validate() const;

  bool empty() const { return centre_m.empty(); }
  bool operator==(const MeasuredRegion& other) const {
    return centre_m == other.centre_m && scale_m == other.scale_m && low_m == other.low_m &&
           high_m == other.high_m && background_T == other.background_T;
  }

  /// What harmonics make at a point (m) of the dish frame, in their own unit; beyond the box as they go on
  /// there, which is no field. Nothing where there are none.
  Eigen::Vector3d sum(const std::vector<double>& harmonics, const Eigen::Vector3d& point_m) const;
  /// Throws DataError that names the point when it lies outside the box.
  void check_holds(const Eigen::Vector3d& point_m) const;
  /// Radius of the largest disc of the needle's plane about the dish centre that lies in the box; 0: none.
  double disc_radius_m() const;
};

/// Whether so many numbers are an expansion: 3, 8, 15, 24, ... of degree 1, 2, 3, 4, ...
bool are_harmonics(std::size_t numbers);

}  // namespace lodestone::physics
