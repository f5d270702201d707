#include "lodestone/session/camera_detector.h"

#include <fmt/core.h>

#include <utility>

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

CameraDetector::CameraDetector(rig::Camera& camera, std::shared_ptr<const vision::Segmenter> segmenter,
                               const physics::RigDescription& rig, const imaging::LensConfig& lens,
                               const CameraSensorConfig& config,
                               std::optional<imaging::Calibration> calibration)
    : camera_(camera),
      segmenter_(std::move(segmenter)),
      bench_(rig::bench_of(rig)),
      lens_(lens),
      config_(config),
      guard_(guard_config(config, lens, calibration), "camera"),
      calibration_(std::move(calibration)) {
  if (calibration_) calibrate();
}

/// Takes up the calibration, and makes it from the present image when there is none.
void CameraDetector::calibrate() {
  if (!calibration_)
    calibration_ = imaging::calibrate_from_dish({frame_.image}, bench_, lens_, config_.calibration);
  vision::LocaliserConfig config = config_.localiser;
  config.rod = vision::rod_of(bench_, config.rod);
  localiser_.emplace(segmenter_, calibration_->camera, bench_.dish_radius_m, config);
  watch_.emplace(*calibration_, bench_);
}

vision::Sighting CameraDetector::slipped() {
  constexpr int kMoved = 2, kDoubtful = 10;  // images; a hand that reaches for the needle is soon gone
  const std::optional<double> moved_m = watch_->moved_m(frame_.image);
  const double bound_m = config_.calibration.moved_bound_m;
  const bool moved = moved_m && *moved_m > bound_m;
  moved_images_ = moved ? moved_images_ + 1 : 0;
  doubtful_images_ = moved || !moved_m ? doubtful_images_ + 1 : 0;
  vision::Sighting none;
  none.stamp_s = frame_.stamp_s;
  if (moved_images_ >= kMoved) {
    none.camera = vision::CameraPlace::kMoved;
    none.reason = fmt::format(
        "the camera has slipped: the dish's rim is {:.2f} mm from where it was calibrated, {:.2f} mm "
        "are allowed (sensor.camera.calibration.moved_bound_m); put it back, or calibrate anew",
        1e3 * *moved_m, 1e3 * bound_m);
  } else if (doubtful_images_ >= kDoubtful) {
    none.camera = vision::CameraPlace::kUnknown;
    none.reason =
        "the dish's rim is not where it was calibrated: something covers it, or the camera has slipped far; "
        "put it back, or calibrate anew";
  }
  return none;
}

vision::Sighting CameraDetector::look() {
  frame_ = camera_.grab(config_.timeout_s);
  guard_.check(frame_);
  if (!localiser_) calibrate();
  if (vision::Sighting none = slipped(); none.camera != vision::CameraPlace::kKept) return none;
  vision::Localisation found = localiser_->locate(frame_.image);
  return {frame_.stamp_s, std::move(found.candidates), found.reason, vision::CameraPlace::kKept};
}

void CameraDetector::expect(const geometry::Vector2& near_m) {
  if (localiser_) localiser_->expect(near_m);
}

void CameraDetector::search() {
  if (localiser_) localiser_->forget();
}

void CameraDetector::reset() {
  guard_.reset();
  search();
}

}  // namespace lodestone::session
