#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/common/random.h"
#include "lodestone/session/needle_detector.h"

namespace lodestone::session {

/// How wrong the simulated localiser is. Defaults: what the shipped segmenter and automatic calibration
/// measure on rendered images (`lodestone evaluate segmenter`, `lodestone calibrate --trials`). The paper's
/// own figures, 0.61 mm and 0.81 degrees with a manual calibration, are in configs/paper.
struct SensorErrorConfig {
  double position_rms_m = 0.000104;
  double heading_rms_deg = 0.154;
  double calibration_offset_m = 1e-6;
  double calibration_scale = 2e-5;
  double calibration_rotation_deg = 0.001;
  double repeatability_m = 2.1e-5;
  double repeatability_deg = 0.018;
  double dropout = 0.003;
  double outliers = 0.0;
  double outlier_from_m = 0.01;
  double outlier_to_m = 0.06;
  double flips = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "position_rms_m", position_rms_m, "m",
        "RMS of the distance between sensed and true position; the error stays while the needle lies still",
        {0.0, 0.1});
    v.field("heading_rms_deg", heading_rms_deg, "deg", "RMS of the heading error, which stays likewise",
            {0.0, 180.0});
    v.field("repeatability_m", repeatability_m, "m", "RMS by which a position differs from image to image",
            {0.0, 0.1});
    v.field("repeatability_deg", repeatability_deg, "deg", "the same of a heading", {0.0, 180.0});
    v.field("calibration_offset_m", calibration_offset_m, "m", "RMS offset of the whole image, fixed per run",
            {0.0, 0.1});
    v.field("calibration_scale", calibration_scale, "",
            "standard deviation of the scale error, fixed per run", {0.0, 0.5});
    v.field("calibration_rotation_deg", calibration_rotation_deg, "deg",
            "standard deviation of the image's rotation, fixed per run", {0.0, 90.0});
    v.field("dropout", dropout, "", "fraction of images without a needle", {0.0, 1.0});
    v.field("outliers", outliers, "", "fraction of images that show the needle elsewhere, from", {0.0, 1.0});
    v.field("outlier_from_m", outlier_from_m, "m", "so far away", {0.0, 0.5});
    v.field("outlier_to_m", outlier_to_m, "m", "to so far", {0.0, 0.5});
    v.field("flips", flips, "", "fraction of images that show the tape at the wrong end", {0.0, 1.0});
  }
};

/// A calibration that is wrong by an offset, a scale and a rotation about the dish centre.
struct CalibrationError {
  geometry::Vector2 offset_m = geometry::Vector2::Zero();
  double scale = 1.0;
  double rotation_rad = 0.0;

  geometry::Pose2 apply(const geometry::Pose2& pose) const;
};

/// Normal errors with the spreads of `config`; the same seed always gives the same error.
CalibrationError draw_calibration_error(const SensorErrorConfig& config, std::uint64_t seed);

/// True pose of a virtual rig as a localiser would report it: calibration error, then an error that changes
/// when the needle moves (what an image shows of it), then a little white noise.
class SimulatedDetector final : public NeedleDetector {
 public:
  /// `true_pose` and `clock` must outlive the sensor.
  SimulatedDetector(std::function<geometry::Pose2()> true_pose, const common::Clock& clock,
                    const SensorErrorConfig& config, const CalibrationError& calibration,
                    common::RandomStream noise);
  vision::Sighting look() override;

  /// The needle has been placed elsewhere: the next error is drawn anew.
  void reset() override { drawn_ = false; }
  /// State of the noise stream, for bitwise resumption after reset().
  std::string save() const { return noise_.save(); }
  void restore(const std::string& state) {
    noise_.restore(state);
    reset();
  }

 private:
  void draw_error(const geometry::Pose2& truth);
  void spoil(geometry::Pose2& pose);

  std::function<geometry::Pose2()> true_pose_;
  const common::Clock& clock_;
  SensorErrorConfig config_;
  CalibrationError calibration_;
  common::RandomStream noise_;
  bool drawn_ = false;
  geometry::Pose2 drawn_at_;  ///< true pose for which the error was drawn
  geometry::Pose2 error_;
};

}  // namespace lodestone::session
