#pragma once

#include <memory>
#include <optional>

#include "lodestone/control/pose_sensor.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/imaging/frame.h"
#include "lodestone/imaging/frame_guard.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/camera.h"
#include "lodestone/vision/commanded_field.h"
#include "lodestone/vision/heading_filter.h"
#include "lodestone/vision/localiser.h"

namespace lodestone::session {

/// How poses are read from images.
struct CameraSensorConfig {
  double timeout_s = 0.5;
  std::int64_t white_level = 250;
  double max_white_fraction = 0.25;
  double min_head_probability = 0.99;
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
    v.field("min_head_probability", min_head_probability, "",
            "that head and tail are told apart rightly, by the tape and by the fields since the head was "
            "last seen, below "
            "which there is no pose",
            {0.5, 1.0});
    v.group("localiser", localiser, "from image to pose");
    v.group("calibration", calibration, "how the camera is fitted to dish and coils");
  }
};

/// Camera -> U-Net -> rod -> head -> pose in the dish frame. Without a calibration it makes one from the
/// first image (the paper's own wish). A needle whose tape is not seen has its head where the fields since
/// say.
class CameraPoseSensor final : public control::PoseSensor {
 public:
  /// `camera` must outlive the sensor. `lens` says how the camera is mounted, as far as that is known; it is
  /// not used when there is a calibration.
  CameraPoseSensor(rig::Camera& camera, std::shared_ptr<const vision::Segmenter> segmenter,
                   const physics::RigDescription& rig, const imaging::LensConfig& lens,
                   const CameraSensorConfig& config,
                   std::optional<imaging::Calibration> calibration = std::nullopt);

  /// No pose and a reason where no single needle is seen for sure. Throws HardwareError when the camera does
  /// not answer or its image is empty, of the wrong kind or size, overexposed or frozen, and DataError when
  /// the first image cannot be calibrated.
  control::PoseEstimate observe() override;
  void pulsed(const std::array<double, rig::kCoilCount>& current_A) override;

  /// The needle has been placed elsewhere: the next image is searched as a whole.
  void reset();

  /// The last image, for those who look on; empty before the first.
  const imaging::Frame& frame() const { return frame_; }
  const std::optional<imaging::Calibration>& calibration() const { return calibration_; }

 private:
  void calibrate();
  /// Turns the pose where the head is at the other end, and says how sure that is.
  double find_head(const vision::Localisation& found, geometry::Pose2& pose);

  rig::Camera& camera_;
  std::shared_ptr<const vision::Segmenter> segmenter_;
  imaging::BenchGeometry bench_;
  imaging::LensConfig lens_;
  CameraSensorConfig config_;
  imaging::FrameGuard guard_;
  std::optional<imaging::Calibration> calibration_;
  std::optional<vision::Localiser> localiser_;
  imaging::Frame frame_;
  vision::CommandedField field_;
  vision::HeadingFilter heading_;
  std::optional<geometry::Vector2> last_m_;  // where the needle was seen last
};

}  // namespace lodestone::session
