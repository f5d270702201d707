#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/session/needle_detector.h"
#include "lodestone/vision/pose_tracker.h"

namespace lodestone::session {

/// Detector -> tracker -> pose. Looks again where an image leaves a doubt.
class TrackedPoseSensor final : public control::PoseSensor {
 public:
  /// `detector` and `clock`, which says how long looks take, must outlive the sensor. `wait` is called before
  /// every look, where a next image needs time to pass that does not pass by itself.
  TrackedPoseSensor(NeedleDetector& detector, const vision::TrackerConfig& config,
                    const physics::RigDescription& rig, const common::Clock& clock,
                    std::function<void()> wait = {})
      : detector_(detector), config_(config), clock_(clock), wait_(std::move(wait)), tracker_(config, rig) {}

  /// Throws HardwareError where the detector does.
  control::PoseEstimate observe() override;
  void acquire() override;
  void pulsed(const physics::PerCoil& current_A,
              const std::vector<physics::PulseOutcome>& outcomes) override {
    tracker_.pulse(current_A, outcomes);
  }
  void pulse_cut() override { tracker_.pulse_cut(); }
  void expect_nothing() override { tracker_.forget(); }
  void forget() override;

 private:
  control::PoseEstimate look();
  control::PoseEstimate timed_look();

  static constexpr double kNear_s = 0.04;    // what a look near the last place is taken to need at first,
  static constexpr double kSearch_s = 0.08;  // and one of the whole dish

  NeedleDetector& detector_;
  vision::TrackerConfig config_;
  const common::Clock& clock_;
  bool searching_ = true;            // the next look is of the whole dish
  double longest_near_s_ = kNear_s;  // that such a look took of late
  double longest_search_s_ = kSearch_s;
  std::function<void()> wait_;
  vision::PoseTracker tracker_;
};

}  // namespace lodestone::session
