#pragma once

#include <memory>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/control/identification_config.h"
#include "lodestone/control/learned_simulator.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/pulse_outcome.h"

namespace lodestone::control {

/// One pulse as it was seen: the pose before it, the drive in A, and the pose after it.
struct SeenPulse {
  geometry::Pose2 before;
  geometry::Drive drive_A = geometry::Drive::Zero(2);
  geometry::Pose2 after;
  double began_s = 0.0;  ///< in the run
};

/// What a learned simulator says of pulses: how likely a motion is, and motions drawn from it, both with what
/// a seen motion differs by besides. Drives beyond what the simulator was shown count as the largest that it
/// was.
class MotionModel {
 public:
  /// `model` predicts distributions. `drive_per_A` takes amperes to its unit of drive.
  MotionModel(std::shared_ptr<const LearnedSimulator> model, const IdentificationConfig& config,
              double drive_per_A);

  /// What is predicted of pulses that are given from one pose, before their motion is seen: most of the work
  /// of judging them.
  struct Prediction {
    geometry::Pose2 before;
    std::size_t pulses = 0;
    std::vector<std::vector<float>> output;  ///< of each member of the ensemble
  };
  void predict(const geometry::Pose2& before, const std::vector<geometry::Drive>& drives_A, Prediction& out);
  /// Where a pulse takes a needle, as one mixture over the ensemble; none where the simulator knows no
  /// headings.
  std::vector<physics::PulseOutcome> outcomes(const geometry::Pose2& before, const geometry::Drive& drive_A);
  /// As below, of one motion by each of these pulses.
  void judge(const Prediction& predicted, const geometry::Pose2& after, std::vector<double>& out);

  /// For each pulse [N] the density of its motion, mean over the ensemble, as a ratio to that of an outlier,
  /// which lies anywhere in the dish; outliers are mixed in by their share. Writes `out` [N], all above 0.
  void judge(const std::vector<SeenPulse>& pulses, std::vector<double>& out);
  /// A pose after the pulse, by a member of the ensemble that is drawn, too; no outlier.
  geometry::Pose2 draw(const geometry::Pose2& before, const geometry::Drive& drive_A,
                       common::RandomStream& random);

 private:
  /// Puts the simulator's drive at `out`, as many numbers as it has.
  void write_drive(const geometry::Drive& drive_A, double* out) const;
  template <class Density>
  void judge_by(std::size_t count, const Density& density, std::vector<double>& out);

  std::shared_ptr<const LearnedSimulator> model_;
  IdentificationConfig config_;
  double drive_per_A_;
  std::vector<double> state_, seen_, drive_, log_density_;
  std::vector<float> weights_;
  Prediction outcomes_;
  inference::FoldedDynamics::Workspace workspace_;
};

}  // namespace lodestone::control
