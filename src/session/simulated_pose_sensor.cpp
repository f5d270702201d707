#include "lodestone/session/simulated_pose_sensor.h"

#include <cmath>
#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::session {

namespace {
// A needle that has moved by less lies still: its image errs as before.
constexpr double kStill_m = 0.1e-3;
constexpr double kStill_rad = 0.002;
// An RMS distance in the plane is spread over two axes.
const double kPerAxis = std::sqrt(0.5);
}  // namespace

geometry::Pose2 CalibrationError::apply(const geometry::Pose2& pose) const {
  const double cosine = std::cos(rotation_rad);
  const double sine = std::sin(rotation_rad);
  return {offset_m.x() + scale * (cosine * pose.x_m - sine * pose.y_m),
          offset_m.y() + scale * (sine * pose.x_m + cosine * pose.y_m),
          geometry::wrap_angle(pose.heading_rad + rotation_rad)};
}

CalibrationError draw_calibration_error(const SensorErrorConfig& config, std::uint64_t seed) {
  common::RandomStream random(seed, "control/calibration");
  CalibrationError error;
  error.offset_m.x() = kPerAxis * config.calibration_offset_m * random.normal();
  error.offset_m.y() = kPerAxis * config.calibration_offset_m * random.normal();
  error.scale = 1.0 + config.calibration_scale * random.normal();
  error.rotation_rad = geometry::kRadPerDeg * config.calibration_rotation_deg * random.normal();
  return error;
}

SimulatedPoseSensor::SimulatedPoseSensor(std::function<geometry::Pose2()> true_pose,
                                         const common::Clock& clock, const SensorErrorConfig& config,
                                         const CalibrationError& calibration, common::RandomStream noise)
    : true_pose_(std::move(true_pose)),
      clock_(clock),
      config_(config),
      calibration_(calibration),
      noise_(std::move(noise)) {}

/// The error of one image of the needle; it is another once the needle lies elsewhere.
void SimulatedPoseSensor::draw_error(const geometry::Pose2& truth) {
  const bool moved = (truth.position_m() - drawn_at_.position_m()).norm() > kStill_m ||
                     std::abs(geometry::wrap_angle(truth.heading_rad - drawn_at_.heading_rad)) > kStill_rad;
  if (drawn_ && !moved) return;
  drawn_ = true;
  drawn_at_ = truth;
  error_ = {kPerAxis * config_.position_rms_m * noise_.normal(),
            kPerAxis * config_.position_rms_m * noise_.normal(),
            geometry::kRadPerDeg * config_.heading_rms_deg * noise_.normal()};
}

control::PoseEstimate SimulatedPoseSensor::observe() {
  control::PoseEstimate estimate;
  estimate.stamp_s = clock_.now_s();
  if (config_.dropout > 0.0 && noise_.uniform() < config_.dropout) {
    estimate.reason = "the simulated localiser found no needle";
    return estimate;
  }
  const geometry::Pose2 truth = true_pose_();
  draw_error(truth);
  const double jitter_m = kPerAxis * config_.repeatability_m;
  const double jitter_rad = geometry::kRadPerDeg * config_.repeatability_deg;
  estimate.pose = calibration_.apply(truth);
  estimate.pose.x_m += error_.x_m + jitter_m * noise_.normal();
  estimate.pose.y_m += error_.y_m + jitter_m * noise_.normal();
  estimate.pose.heading_rad =
      geometry::wrap_angle(estimate.pose.heading_rad + error_.heading_rad + jitter_rad * noise_.normal());
  estimate.position_sigma_m = std::hypot(config_.position_rms_m, config_.repeatability_m);
  estimate.heading_sigma_rad =
      geometry::kRadPerDeg * std::hypot(config_.heading_rms_deg, config_.repeatability_deg);
  estimate.valid = true;
  return estimate;
}

}  // namespace lodestone::session
