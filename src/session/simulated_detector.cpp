#include "lodestone/session/simulated_detector.h"

#include <cmath>
#include <utility>

#include "lodestone/geometry/angle.h"

namespace lodestone::session {

namespace {
// A needle that has moved by less lies still: its image errs as before.
constexpr double kStill_m = 0.1e-3;
constexpr double kStill_rad = 0.002;
constexpr double kTapeLogOdds = 10.0;  // of a tape in plain view
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

SimulatedDetector::SimulatedDetector(std::function<geometry::Pose2()> true_pose, const common::Clock& clock,
                                     const SensorErrorConfig& config, const CalibrationError& calibration,
                                     common::RandomStream noise)
    : true_pose_(std::move(true_pose)),
      clock_(clock),
      config_(config),
      calibration_(calibration),
      noise_(std::move(noise)) {}

/// The error of one image of the needle; it is another once the needle lies elsewhere.
void SimulatedDetector::draw_error(const geometry::Pose2& truth) {
  const bool moved = (truth.position_m() - drawn_at_.position_m()).norm() > kStill_m ||
                     std::abs(geometry::wrap_angle(truth.heading_rad - drawn_at_.heading_rad)) > kStill_rad;
  if (drawn_ && !moved) return;
  drawn_ = true;
  drawn_at_ = truth;
  error_ = {kPerAxis * config_.position_rms_m * noise_.normal(),
            kPerAxis * config_.position_rms_m * noise_.normal(),
            geometry::kRadPerDeg * config_.heading_rms_deg * noise_.normal()};
}

/// Sometimes an image shows something else.
void SimulatedDetector::spoil(geometry::Pose2& pose) {
  if (config_.outliers > 0.0 && noise_.uniform() < config_.outliers) {
    const double distance_m =
        config_.outlier_from_m + noise_.uniform() * (config_.outlier_to_m - config_.outlier_from_m);
    const double direction_rad = 2.0 * geometry::kPi * noise_.uniform();
    pose.x_m += distance_m * std::cos(direction_rad);
    pose.y_m += distance_m * std::sin(direction_rad);
  }
  if (config_.flips > 0.0 && noise_.uniform() < config_.flips)
    pose.heading_rad = geometry::wrap_angle(pose.heading_rad + geometry::kPi);
}

vision::Sighting SimulatedDetector::look() {
  vision::Sighting sighting;
  sighting.stamp_s = clock_.now_s();
  if (config_.dropout > 0.0 && noise_.uniform() < config_.dropout) {
    sighting.reason = "the simulated localiser found no needle";
    return sighting;
  }
  const geometry::Pose2 truth = true_pose_();
  draw_error(truth);
  const double jitter_m = kPerAxis * config_.repeatability_m;
  const double jitter_rad = geometry::kRadPerDeg * config_.repeatability_deg;
  vision::Rod rod;
  rod.found = rod.axis_found = true;
  rod.tape_log_odds = kTapeLogOdds;
  rod.head_certainty = 1.0 / (1.0 + std::exp(-kTapeLogOdds));
  rod.support = 1.0;
  rod.pose = calibration_.apply(truth);
  rod.pose.x_m += error_.x_m + jitter_m * noise_.normal();
  rod.pose.y_m += error_.y_m + jitter_m * noise_.normal();
  rod.pose.heading_rad =
      geometry::wrap_angle(rod.pose.heading_rad + error_.heading_rad + jitter_rad * noise_.normal());
  spoil(rod.pose);
  const double sigma_m = kPerAxis * std::hypot(config_.position_rms_m, config_.repeatability_m);
  const double sigma_rad =
      geometry::kRadPerDeg * std::hypot(config_.heading_rms_deg, config_.repeatability_deg);
  rod.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  sighting.candidates.push_back(rod);
  return sighting;
}

}  // namespace lodestone::session
