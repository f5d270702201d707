#pragma once

#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/control/motion_model.h"
#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Estimates the one number by which most rigs of a kind differ: a factor on the drive, by Bayes' rule on a
/// grid, from what every pulse did against what the learned simulator says it does at each factor. Friction
/// stays with the place: of the pulses that moved nothing at one place only what the most telling of them
/// says counts, at each factor, however often they are repeated.
class GainFilter {
 public:
  /// The largest factor, and one over the smallest.
  static constexpr double kMostGain = 3.0;

  GainFilter(MotionModel model, const IdentificationConfig& config);

  /// Back to what is known before any pulse.
  void reset();
  /// One more pulse.
  void learn(const SeenPulse& pulse);

  /// Mean and spread of the logarithm.
  task::DriveGain gain() const;

  /// What it knows, and back. restore() throws DataError.
  common::Json save() const;
  void restore(const common::Json& state);

 private:
  /// Whether the needle has not left its place.
  bool still(const geometry::Pose2& pose) const;

  IdentificationConfig config_;
  MotionModel model_;
  std::vector<double> factor_;       // of the grid
  std::vector<double> weight_;       // of its points; they sum to 1
  geometry::Pose2 place_;            // where the needle came to lie
  std::vector<double> stalled_;      // of its points: the least that a pulse which moved nothing there said
  std::vector<SeenPulse> imagined_;  // at every factor
  std::vector<double> says_;         // of the points, what the last pulse says; at most 1
};

}  // namespace lodestone::control
