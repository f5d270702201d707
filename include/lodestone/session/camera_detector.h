#pragma once

#include <memory>
#include <optional>

#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/imaging/frame.h"
#include "lodestone/imaging/frame_guard.h"
#include "lodestone/imaging/rim_watch.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/camera.h"
#include "lodestone/session/needle_detector.h"
#include "lodestone/vision/localiser.h"

namespace lodestone::session {

/// How poses are read from images.
struct CameraSensorConfig {
  double timeout_s = 0.5;
  std::int64_t white_level = 250;
  double max_white_fraction = 0.25;
  vision::LocaliserConfig localiser;
  imaging::CalibrationConfig calibration;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("timeout_s", timeout_s, "s", "a camera that gives no image for so long has failed", {1e-3, 60.0});
    v.field("white_level", white_level, "grey levels", "a pixel is clipped when all its colours reach this",
            {1, 255});
    v.retired("max_white_share", "max_white_fraction");
    v.field("max_white_fraction", max_white_fraction, "", "an image with more clipped pixels is overexposed",
            {0.0, 1.0});
    v.retired("min_head_probability", "sensor.tracker.min_head_probability");
    v.group("localiser", localiser, "from image to pose");
    v.group("calibration", calibration, "how the camera is fitted to dish and coils");
  }
};

/// Camera -> U-Net -> rods in the dish frame. Without a calibration it makes one from the first image (the
/// paper's own wish). Once the dish's rim is no longer where it was calibrated (CalibrationConfig's
/// moved_bound_m, in two images in a row), or nowhere for ten, no needle is seen until it is again.
class CameraDetector final : public NeedleDetector {
 public:
  /// `camera` must outlive the detector. `lens` says how the camera is mounted, as far as that is known; it
  /// is not used when there is a calibration.
  CameraDetector(rig::Camera& camera, std::shared_ptr<const vision::Segmenter> segmenter,
                 const physics::RigDescription& rig, const imaging::LensConfig& lens,
                 const CameraSensorConfig& config,
                 std::optional<imaging::Calibration> calibration = std::nullopt);

  /// Throws HardwareError when the camera does not answer or its image is empty, of the wrong kind or size,
  /// overexposed or frozen, and DataError when the first image cannot be calibrated.
  vision::Sighting look() override;
  void expect(const geometry::Vector2& near_m) override;
  void search() override;
  void reset() override;

  /// The last image, for those who look on; empty before the first.
  const imaging::Frame& frame() const { return frame_; }
  const std::optional<imaging::Calibration>& calibration() const { return calibration_; }

 private:
  void calibrate();
  /// Nothing, and whether the camera stands where it stood.
  vision::Sighting slipped();

  rig::Camera& camera_;
  std::shared_ptr<const vision::Segmenter> segmenter_;
  imaging::BenchGeometry bench_;
  imaging::LensConfig lens_;
  CameraSensorConfig config_;
  imaging::FrameGuard guard_;
  std::optional<imaging::Calibration> calibration_;
  std::optional<vision::Localiser> localiser_;
  std::optional<imaging::RimWatch> watch_;
  int moved_images_ = 0;     // in a row
  int doubtful_images_ = 0;  // likewise, with those in which nothing is where the rim was
  imaging::Frame frame_;
};

}  // namespace lodestone::session
