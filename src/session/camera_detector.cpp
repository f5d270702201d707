#include "lodestone/session/camera_detector.h"

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
}

vision::Sighting CameraDetector::look() {
  frame_ = camera_.grab(config_.timeout_s);
  guard_.check(frame_);
  if (!localiser_) calibrate();
  vision::Localisation found = localiser_->locate(frame_.image);
  return {frame_.stamp_s, std::move(found.candidates), found.reason};
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
