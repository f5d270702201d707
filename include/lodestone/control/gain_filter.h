#pragma once

#include <optional>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/control/motion_model.h"
#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Estimates the one number by which most rigs of a kind differ: a factor on the drive, by Bayes' rule on a
/// grid, from what every pulse did against what the learned simulator says it does at each factor. A part of
/// it belongs to the place, where friction stays as it is: a stall that is repeated counts each time, and
/// what is known grows less sure when the needle has moved (process noise).
class GainFilter {
 public:
  /// The largest factor, and one over the smallest.
  static constexpr double kMostGain = 3.0;
  /// Gains that are told apart, to each side of 1.
  static constexpr int kSteps = 20;

  GainFilter(MotionModel model, const IdentificationConfig& config);

  /// Back to what is known before any pulse.
  void reset();
  /// A pulse is being given: what is to be known of it before its motion is seen is worked out now, which is
  /// most of what learn() has to do.
  void expect(const geometry::Pose2& before, const geometry::Drive& drive_A);
  /// One more pulse, expected or not.
  void learn(const SeenPulse& pulse);

  /// Where a pulse takes the needle on a rig of the likeliest gain.
  std::vector<physics::PulseOutcome> outcomes(const geometry::Pose2& before, const geometry::Drive& drive_A);

  /// Mean and spread of the logarithm.
  task::DriveGain gain() const;

  /// What it knows, and back. restore() throws DataError.
  common::Json save() const;
  void restore(const common::Json& state);

 private:
  IdentificationConfig config_;
  /// The needle lies elsewhere.
  void move_on();

  MotionModel model_;
  std::vector<double> factor_;             // of the grid
  std::vector<double> weight_;             // of its points; they sum to 1
  std::vector<geometry::Drive> imagined_;  // drives in A at every factor,
  MotionModel::Prediction predicted_;      // and what they do
  std::optional<geometry::Drive> expected_A_;
  std::vector<double> says_;    // of the points, what the last pulse says
  std::vector<double> kernel_;  // by distance in points, what a new place makes of one
};

}  // namespace lodestone::control
