#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/pulse_outcome.h"
#include "lodestone/rig/coils.h"

namespace lodestone::control {

struct PoseEstimate {
  bool valid = false;  ///< false: no pose, and `reason` says why; never a guess
  std::string reason;
  geometry::Pose2 pose;
  /// Not valid only because head and tail cannot be told apart: the needle lies as the pose says, or the
  /// other way round.
  bool either_way = false;
  double position_sigma_m = 0.0;
  double heading_sigma_rad = 0.0;
  double stamp_s = 0.0;  ///< on the rig's clock
  bool fault =
      false;  ///< the sensor itself has failed (a camera that is gone), which no next observation mends
  /// How far from where it was expected, squared and in units of the spread that was expected (normalised
  /// innovation of 2 degrees of freedom: 2 on average); nothing where nothing was expected.
  std::optional<double> innovation;
  /// Not valid, and not to be looked for: something covers the dish, or the camera is not where it was
  /// calibrated.
  bool blind = false;
  bool camera_moved = false;  ///< blind because the camera has been seen to have moved
  Eigen::Matrix2d position_covariance_m2 = Eigen::Matrix2d::Zero();
};

/// Where the needle is. Implementations: simulated (true pose plus the localiser's measured error);
/// camera-based.
class PoseSensor {
 public:
  virtual ~PoseSensor() = default;
  virtual PoseEstimate observe() = 0;
  /// Takes its time to find a needle that it does not know yet: before a run begins, when nothing can be
  /// late.
  virtual void acquire() {}
  /// What the coils were asked for since the last observation, for a sensor that expects the needle to obey;
  /// and where a learned simulator says that it takes the needle from the pose that was observed, if anybody
  /// has asked one.
  virtual void pulsed(const physics::PerCoil& /*current_A*/,
                      const std::vector<physics::PulseOutcome>& /*outcomes*/) {}
  /// The coils went off before the pulse that it was last told of was over: what that did, nobody knows.
  virtual void pulse_cut() {}
  /// The needle was moved in a way that nobody can foresee.
  virtual void expect_nothing() {}
  /// It has been placed elsewhere: a new episode begins.
  virtual void forget() {}
};

}  // namespace lodestone::control
