#include "lodestone/control/simulated_pose_sensor.h"

#include <cmath>
#include <utility>

namespace lodestone::control {

namespace {
constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
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
  error.rotation_rad = kRadPerDeg * config.calibration_rotation_deg * random.normal();
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

PoseEstimate SimulatedPoseSensor::observe() {
  PoseEstimate estimate;
  estimate.stamp_s = clock_.now_s();
  if (config_.dropout > 0.0 && noise_.uniform() < config_.dropout) {
    estimate.reason = "the simulated localiser found no needle";
    return estimate;
  }
  const double sigma_m = kPerAxis * config_.position_rms_m;
  const double sigma_rad = kRadPerDeg * config_.heading_rms_deg;
  estimate.pose = calibration_.apply(true_pose_());
  estimate.pose.x_m += sigma_m * noise_.normal();
  estimate.pose.y_m += sigma_m * noise_.normal();
  estimate.pose.heading_rad = geometry::wrap_angle(estimate.pose.heading_rad + sigma_rad * noise_.normal());
  estimate.position_sigma_m = sigma_m;
  estimate.heading_sigma_rad = sigma_rad;
  estimate.valid = true;
  return estimate;
}

}  // namespace lodestone::control
