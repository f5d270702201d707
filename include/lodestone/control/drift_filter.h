#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "lodestone/control/motion_model.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/pulse_outcome.h"

namespace lodestone::control {

/// How far a needle goes with a flow on a pulse from one pose to another, which would carry it by `across_m`
/// if it lay across the flow: half as far along itself, as half the drag does (resistive-force theory: Gray
/// and Hancock, J. Exp. Biol. 32, 1955).
geometry::Vector2 carried_m(const geometry::Vector2& across_m, const geometry::Pose2& from,
                            const geometry::Pose2& to);

/// Estimates what carries a needle while pulses move it and friction does not hold it: a flow, steady or
/// pulsing, which no simulator was shown. What is left of every pulse's motion over what was predicted is
/// explained in many ways at once: by a fluid at rest, by a drift that stays, and by drifts that rise and
/// fall about a mean at each of many frequencies, each with a Kalman filter of its own (multiple-model
/// adaptive estimation: Magill, IEEE Trans. Autom. Control 10, 1965). Bayes' rule says how far each is
/// believed.
class DriftFilter {
 public:
  /// Nothing is ever estimated where `config.drift_m` is 0.
  explicit DriftFilter(const IdentificationConfig& config);

  /// Back to a fluid at rest.
  void reset();
  /// One more pulse, of which this was predicted by a gain that is as unsure as `log_gain_sigma`. One that
  /// has not moved the needle says nothing.
  void learn(const SeenPulse& pulse, const std::vector<physics::PulseOutcome>& predicted,
             double log_gain_sigma = 0.0);
  /// How likely it is that anything carries the needle.
  double flow_probability() const { return 1.0 - rest_weight_; }
  /// What a needle that lies across it is carried by (m) in each of so many pulses, should they move it:
  /// empty while rest is likelier.
  std::vector<geometry::Vector2> drifts_m(double begin_s, double period_s, std::size_t pulses) const;
  /// What of a pulse's motion is put down to that, by what was known before.
  geometry::Vector2 by_flow_m(const SeenPulse& pulse) const;

 private:
  geometry::Vector2 drift_m(double begins_s) const;

  /// A drift of mean + cosine + sine, two numbers each.
  struct Wave {
    double frequency_Hz = 0.0;
    double weight = 1.0;
    Eigen::Matrix<double, 6, 1> mean_m = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix<double, 6, 6> variance_m2 = Eigen::Matrix<double, 6, 6>::Zero();
    double evidence = 0.0;  // of the last pulse, logarithm
  };

  IdentificationConfig config_;
  double rest_weight_ = 1.0;
  std::vector<Wave> waves_;  // their weights and that of rest sum to 1
  double learned_s_ = 0.0;
};

}  // namespace lodestone::control
