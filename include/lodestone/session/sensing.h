#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/physics/obstacles.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/free_running_camera.h"
#include "lodestone/rig/rendered_camera.h"
#include "lodestone/session/camera_detector.h"
#include "lodestone/session/simulated_detector.h"
#include "lodestone/session/tracked_pose_sensor.h"

namespace lodestone::session {

/// How the pose of a virtual rig's needle is sensed.
struct SensingConfig {
  std::string kind = "camera";
  std::string segmenter;
  std::string calibration;
  CameraSensorConfig camera;
  imaging::SceneConfig scene;
  SensorErrorConfig simulated;
  vision::TrackerConfig tracker;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "kind", kind, "",
        "camera: images are rendered and localised; simulated: the true pose plus the localiser's measured "
        "error",
        {"camera", "simulated"});
    v.field("segmenter", segmenter, "", "folder of the segmenter checkpoint; empty: the one that is shipped");
    v.field("calibration", calibration, "",
            "calibration.json of a real bench, as lodestone calibrate wrote it; empty: made from the first "
            "image");
    v.group("camera", camera, "from images to poses");
    v.group("scene", scene, "what the bench looks like; sizes of dish, coils and needle come from the rig");
    v.group("simulated", simulated, "errors of the simulated localiser");
    v.group("tracker", tracker, "from what images show to the pose");
  }
};

/// One look of a bench with its camera: scene, and calibration when it has been made. Shared by the trials on
/// the same bench.
struct SeenBench {
  std::uint64_t seed = 0;  ///< of the scene, or of the simulated calibration error
  std::shared_ptr<const imaging::SceneRenderer> renderer;
  std::optional<imaging::Calibration> calibration;
};

/// Whether images come when the sensor asks, or all the time, as from a real camera: then the rig's time has
/// to pass by itself (VirtualRig::keep_pace_with).
enum class Images { kWhenAsked, kAllTheTime };

/// Pose sensor of one virtual rig, of the configured kind.
class RigSensor final : public control::PoseSensor {
 public:
  RigSensor(rig::VirtualRig& rig, const SensingConfig& config,
            std::shared_ptr<const vision::Segmenter> segmenter, const SeenBench& bench,
            common::RandomStream noise, common::Clock* clock = nullptr, Images images = Images::kWhenAsked);
  ~RigSensor() override;

  control::PoseEstimate observe() override;
  void acquire() override { tracked_->acquire(); }
  void pulsed(const physics::PerCoil& current_A, const std::vector<physics::PulseOutcome>& outcomes) override;
  void pulse_cut() override { tracked_->pulse_cut(); }
  void expect_nothing() override { tracked_->expect_nothing(); }
  void forget() override;
  /// Null when the sensor is simulated.
  const CameraDetector* camera() const { return by_camera_ ? &*by_camera_ : nullptr; }

  /// Null where images do not come all the time.
  const rig::FreeRunningCamera* watched() const { return watched_; }

  /// State of the noise, for bitwise resumption between two episodes.
  std::string save() const;
  void restore(const std::string& state);

 private:
  void wait_for_image(rig::VirtualRig& rig, double timeout_s) const;

  std::optional<SimulatedDetector> simulated_;
  class RigTime;
  std::unique_ptr<RigTime> rig_time_;
  std::unique_ptr<rig::Camera> camera_;
  rig::RenderedCamera* rendered_ = nullptr;
  rig::FreeRunningCamera* watched_ = nullptr;
  std::optional<CameraDetector> by_camera_;
  std::optional<TrackedPoseSensor> tracked_;
};

/// Makes sensors: reads the segmenter once, and paints and calibrates benches.
class Sensing {
 public:
  /// Throws CheckpointError when the segmenter cannot be read.
  Sensing(const SensingConfig& config, const rig::VirtualRigConfig& rig);

  /// A bench seen under one seed, calibrated from an image of the empty dish, as an operator would before
  /// placing the needle. Throws DataError when that fails.
  SeenBench calibrated_bench(std::uint64_t seed) const;
  /// The same without calibration: the sensor then calibrates itself on its first image. `more` obstacles
  /// stand there besides those of the rig.
  SeenBench new_bench(std::uint64_t seed, const std::vector<physics::ObstacleConfig>& more = {}) const;
  /// `clock`: what moves the rig's time where the rig does not do so itself.
  std::unique_ptr<RigSensor> make(rig::VirtualRig& rig, const SeenBench& bench, common::RandomStream noise,
                                  common::Clock* clock = nullptr, Images images = Images::kWhenAsked) const;

  bool by_camera() const { return config_.kind == "camera"; }
  const imaging::BenchGeometry& bench() const { return config_.scene.bench; }

 private:
  SensingConfig config_;  // with the bench as it is described
  imaging::BenchGeometry rendered_bench_;
  std::shared_ptr<const vision::Segmenter> segmenter_;
};

}  // namespace lodestone::session
