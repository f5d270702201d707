#include "lodestone/session/camera_pose_sensor.h"

#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/rig/rendered_camera.h"

namespace lodestone::session {

namespace {

imaging::FrameGuardConfig guard_config(const CameraSensorConfig& config, const imaging::LensConfig& lens,
                                       const std::optional<imaging::Calibration>& calibration) {
  imaging::FrameGuardConfig guard;
  guard.width_px = calibration ? calibration->camera.width_px : lens.width_px;
  guard.height_px = calibration ? calibration->camera.height_px : lens.height_px;
  guard.white_level = config.white_level;
  guard.max_white_fraction = config.max_white_fraction;
  return guard;
}

}  // namespace

CameraPoseSensor::CameraPoseSensor(rig::Camera& camera, std::shared_ptr<const vision::Segmenter> segmenter,
                                   const physics::RigDescription& rig, const imaging::LensConfig& lens,
                                   const CameraSensorConfig& config,
                                   std::optional<imaging::Calibration> calibration)
    : camera_(camera),
      segmenter_(std::move(segmenter)),
      bench_(rig::bench_of(rig)),
      lens_(lens),
      config_(config),
      guard_(guard_config(config, lens, calibration), "camera"),
      calibration_(std::move(calibration)),
      field_(rig) {
  if (calibration_) calibrate();
}

/// Takes up the calibration, and makes it from the present image when there is none.
void CameraPoseSensor::calibrate() {
  if (!calibration_)
    calibration_ = imaging::calibrate_from_dish({frame_.image}, bench_, lens_, config_.calibration);
  vision::LocaliserConfig config = config_.localiser;
  config.rod = vision::rod_of(bench_, config.rod);
  localiser_.emplace(segmenter_, calibration_->camera, bench_.dish_radius_m, config);
}

control::PoseEstimate CameraPoseSensor::observe() {
  frame_ = camera_.grab(config_.timeout_s);
  guard_.check(frame_);
  if (!localiser_) calibrate();
  const vision::Localisation found = localiser_->locate(frame_.image);
  control::PoseEstimate estimate;
  estimate.stamp_s = frame_.stamp_s;
  estimate.reason = found.reason;
  if (!found.axis_found) return estimate;
  estimate.pose = found.pose;
  last_m_ = found.pose.position_m();
  estimate.valid = find_head(found, estimate.pose) >= config_.min_head_probability;
  estimate.reason = estimate.valid ? "" : "head and tail cannot be told apart";
  estimate.position_sigma_m = std::sqrt(found.covariance(0, 0) + found.covariance(1, 1));
  estimate.heading_sigma_rad = std::sqrt(found.covariance(2, 2));
  return estimate;
}

double CameraPoseSensor::find_head(const vision::Localisation& found, geometry::Pose2& pose) {
  const double probability =
      heading_.see(pose.heading_rad, std::sqrt(found.covariance(2, 2)), found.tape_log_odds);
  if (probability >= 0.5) return probability;
  pose.heading_rad = geometry::wrap_angle(pose.heading_rad + geometry::kPi);
  return 1.0 - probability;
}

void CameraPoseSensor::pulsed(const std::array<double, rig::kCoilCount>& current_A) {
  if (!last_m_) return;
  if (const auto field_rad = field_.direction_rad(current_A, *last_m_)) heading_.pulse(*field_rad);
}

void CameraPoseSensor::reset() {
  guard_.reset();
  heading_.reset();
  last_m_.reset();
  if (localiser_) localiser_->forget();
}

}  // namespace lodestone::session
