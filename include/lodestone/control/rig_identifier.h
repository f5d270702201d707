#pragma once

#include <memory>
#include <optional>

#include "lodestone/common/config.h"
#include "lodestone/control/drift_filter.h"
#include "lodestone/control/gain_filter.h"
#include "lodestone/control/residual_watch.h"

namespace lodestone::control {

/// What the pulses of a run say about its rig: how strongly it answers, what its fluid carries the needle by,
/// and whether that still explains what they do.
class RigIdentifier {
 public:
  /// As MotionModel.
  RigIdentifier(const std::shared_ptr<const LearnedSimulator>& model, const IdentificationConfig& config,
                double drive_per_A)
      : filter_({model, config, drive_per_A}, config),
        drift_(config),
        watch_({model, config, drive_per_A}, config.noise_m, config.noise_rad) {}

  void reset();
  /// A run begins, and with it time: of a flow nothing is known.
  void begin_run() { drift_.reset(); }
  /// A pulse is being given: as GainFilter. Decisions need not wait for it.
  void expect(const geometry::Pose2& before, const geometry::Drive& drive_A) {
    filter_.expect(before, drive_A);
  }
  /// Where it takes the needle, as far as the rig is known.
  std::vector<physics::PulseOutcome> outcomes(const geometry::Pose2& before, const geometry::Drive& drive_A) {
    return filter_.outcomes(before, drive_A);
  }
  /// One more pulse.
  void learn(const SeenPulse& pulse);
  task::DriveGain gain() const { return filter_.gain(); }
  /// As DriftFilter.
  std::vector<geometry::Vector2> drifts_m(double begin_s, double period_s, std::size_t pulses) const {
    return drift_.drifts_m(begin_s, period_s, pulses);
  }
  /// Judges the pulse that was learned from last, once. Decisions need not wait for it.
  void check();
  /// As ResidualWatch.
  double change_evidence() const { return watch_.evidence(); }
  bool changed() const { return watch_.changed(); }

  /// What is known of the gain, and back; drift and watch begin anew. restore() throws DataError.
  common::Json save() const { return filter_.save(); }
  void restore(const common::Json& state);

 private:
  GainFilter filter_;
  DriftFilter drift_;
  ResidualWatch watch_;
  std::optional<SeenPulse> unchecked_;
  task::DriveGain gain_before_;  // that pulse
};

}  // namespace lodestone::control
