#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

/// Friction between needle and dish.
struct FrictionConfig {
  double static_coefficient = 0.30;   // D: steel on plastic 0.20-0.45 (Q)
  double kinetic_coefficient = 0.20;  // D: steel on plastic 0.18-0.35 (Q)
  double stribeck_speed_m_s = 5e-3;   // D
  double map_sigma = 0.30;            // D: 0.25-0.35 from the scatter of recorded pulses
  double map_correlation_m = 4e-3;    // D: "a few mm"
  double pulse_sigma = 0.10;          // D: about 10 % from pulse to pulse
  double rolling_arm_m = 1e-4;        // S: of a sphere; published tables have it for steel balls on steel

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("static_coefficient", static_coefficient, "", "mean coefficient of static friction", {0.0, 5.0});
    v.field("kinetic_coefficient", kinetic_coefficient, "", "mean coefficient of kinetic friction",
            {0.0, 5.0});
    v.field("stribeck_speed_m_s", stribeck_speed_m_s, "m/s",
            "speed over which friction falls from static to kinetic", {1e-5, 1.0});
    v.field("map_sigma", map_sigma, "", "standard deviation of the log of friction over the dish",
            {0.0, 2.0});
    v.field("map_correlation_m", map_correlation_m, "m", "correlation length of friction over the dish",
            {1e-3, 0.1});
    v.field("pulse_sigma", pulse_sigma, "", "standard deviation of the log of friction from pulse to pulse",
            {0.0, 2.0});
    v.field("rolling_arm_m", rolling_arm_m, "m",
            "of a sphere that rolls: the torque against it is this times what the floor carries",
            {1e-7, 0.01});
  }
  /// Throws ConfigError when kinetic exceeds static friction.
  void validate() const;
};

/// A log-normal field of friction factors with mean 1 over a square around the dish: exp(sigma g - sigma^2 /
/// 2) with g a standard normal field of covariance exp(-r^2 / (2 correlation^2)), on a 1 mm grid, bilinear
/// between.
class FrictionMap {
 public:
  /// Draws the map from (seed, "friction_map"). sigma 0 gives 1 everywhere.
  FrictionMap(const FrictionConfig& config, double reach_m, std::uint64_t seed);

  /// Factor at a point; points outside the reach take the value of the edge.
  double factor(double x_m, double y_m) const;

 private:
  double reach_m_;
  int nodes_ = 0;              // per side; 0 when uniform
  std::vector<float> factor_;  // [nodes, nodes], x-major
};

}  // namespace lodestone::physics
