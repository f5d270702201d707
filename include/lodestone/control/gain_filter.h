#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lodestone/control/learned_simulator.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/task/observation.h"

namespace lodestone::control {

/// How a rig is identified while it is driven.
struct IdentificationConfig {
  bool enabled = true;
  bool carry = false;
  double prior_log_sigma = 0.45;
  double temper = 0.7;
  double noise_m = 0.5e-3;
  double noise_rad = 0.05;
  double outlier_share = 0.1;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("enabled", enabled, "", "estimate from the pulses how strongly the rig answers to a drive");
    v.field("carry", carry, "", "on a bench, a trial begins with what the one before knew of it");
    v.field("prior_log_sigma", prior_log_sigma, "",
            "how much rigs differ: standard deviation of the logarithm of the gain", {1e-3, 2.0});
    v.field("temper", temper, "",
            "power of the likelihood: friction stays with the place, so pulses are not "
            "independent",
            {0.01, 1.0});
    v.field("noise_m", noise_m, "m", "what a motion may differ from the simulator by besides", {1e-6, 0.1});
    v.field("noise_rad", noise_rad, "rad", "and a turn", {1e-4, 1.0});
    v.field("outlier_share", outlier_share, "", "pulses that may do anything", {1e-6, 0.9});
  }
};

/// Estimates the one number by which most rigs of a kind differ: a factor on the drive, by Bayes' rule on a
/// grid, from what every pulse did against what the learned simulator says it does at each factor.
class GainFilter {
 public:
  /// The largest factor, and one over the smallest.
  static constexpr double kMostGain = 3.0;

  /// `model` predicts distributions. `drive_per_A` takes amperes to its unit of drive.
  GainFilter(std::shared_ptr<const LearnedSimulator> model, const IdentificationConfig& config,
             double drive_per_A);

  /// Back to what is known before any pulse.
  void reset();
  /// One pulse: the pose before it, the drive of the axes in A, and the pose after it.
  void pulse(const geometry::Pose2& before, const geometry::Vector2& drive_A, const geometry::Pose2& after);

  /// Mean and spread of the logarithm.
  task::DriveGain gain() const;

 private:
  std::shared_ptr<const LearnedSimulator> model_;
  IdentificationConfig config_;
  double drive_per_A_;
  std::vector<double> log_gain_;  // of the grid
  std::vector<double> weight_;    // of its points; they sum to 1
  std::vector<double> state_, seen_, drive_, density_, sum_;
  inference::FoldedDynamics::Workspace workspace_;
};

}  // namespace lodestone::control
