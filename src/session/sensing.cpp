#include "lodestone/session/sensing.h"

#include "lodestone/common/error.h"

namespace lodestone::session {

namespace {
constexpr double kImagePeriod_s = 1.0 / 30.0;  // of a rendered camera that runs freely
}

/// The rig's time for a camera that only looks: waiting does not move it.
class RigSensor::RigTime final : public common::Clock {
 public:
  explicit RigTime(rig::VirtualRig& rig) : rig_(rig) {}
  double now_s() const override { return rig_.clock().now_s(); }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    return wall_.wait_until(wall_.now_s() + time_s - now_s(), interruption);
  }

 private:
  rig::VirtualRig& rig_;
  common::SteadyClock wall_;
};

RigSensor::RigSensor(rig::VirtualRig& rig, const SensingConfig& config,
                     std::shared_ptr<const vision::Segmenter> segmenter, const SeenBench& bench,
                     common::RandomStream noise, common::Clock* clock, Images images) {
  if (config.kind == "camera") {
    if (images == Images::kAllTheTime) rig_time_ = std::make_unique<RigTime>(rig);
    auto rendered = std::make_unique<rig::RenderedCamera>(rig, bench.renderer, noise,
                                                          rig_time_ ? rig_time_.get() : clock);
    rendered_ = rendered.get();
    camera_ = std::move(rendered);
    if (images == Images::kAllTheTime) {
      auto watched = std::make_unique<rig::FreeRunningCamera>(std::move(camera_), config.camera.timeout_s,
                                                              kImagePeriod_s);
      watched_ = watched.get();
      camera_ = std::move(watched);
    }
    by_camera_.emplace(*camera_, std::move(segmenter), rig.config(), config.scene.lens, config.camera,
                       bench.calibration);
  } else {
    simulated_.emplace([&rig] { return rig.true_pose(); }, clock != nullptr ? *clock : rig.clock(),
                       config.simulated, draw_calibration_error(config.simulated, bench.seed), noise);
  }
  NeedleDetector& detector =
      by_camera_ ? static_cast<NeedleDetector&>(*by_camera_) : static_cast<NeedleDetector&>(*simulated_);
  std::function<void()> wait;
  if (watched_ != nullptr)
    wait = [this, &rig, timeout_s = config.camera.timeout_s] { wait_for_image(rig, timeout_s); };
  tracked_.emplace(detector, config.tracker, rig.config(), clock != nullptr ? *clock : rig.clock(), wait);
}

RigSensor::~RigSensor() = default;

/// Until an image has come that was begun later than the last that was used: an image that was begun at the
/// same time may still be on its way.
void RigSensor::wait_for_image(rig::VirtualRig& rig, double timeout_s) const {
  common::Clock& clock = rig.clock();
  const double until_s = clock.now_s() + timeout_s;
  const auto come = [&] {
    const auto latest = watched_->latest();
    return latest != nullptr && latest->stamp_s > by_camera_->frame().stamp_s;
  };
  while (!come() && clock.now_s() < until_s) clock.sleep_until(clock.now_s() + kImagePeriod_s);
}

control::PoseEstimate RigSensor::observe() { return tracked_->observe(); }

void RigSensor::pulsed(const physics::PerCoil& current_A,
                       const std::vector<physics::PulseOutcome>& outcomes) {
  tracked_->pulsed(current_A, outcomes);
}

void RigSensor::forget() { tracked_->forget(); }

std::string RigSensor::save() const { return rendered_ != nullptr ? rendered_->save() : simulated_->save(); }

void RigSensor::restore(const std::string& state) {
  if (rendered_ != nullptr)
    rendered_->restore(state);
  else
    simulated_->restore(state);
  forget();
}

Sensing::Sensing(const SensingConfig& config, const rig::VirtualRigConfig& rig) : config_(config) {
  config_.scene.bench = rig::bench_of(rig);
  rendered_bench_ = rig::rendered_bench_of(rig);
  if (by_camera()) segmenter_ = vision::Segmenter::load(config.segmenter);
}

SeenBench Sensing::new_bench(std::uint64_t seed, const std::vector<physics::ObstacleConfig>& more) const {
  SeenBench bench;
  bench.seed = seed;
  if (by_camera()) {
    imaging::SceneConfig scene = config_.scene;
    scene.bench = rendered_bench_;
    for (const physics::ObstacleConfig& obstacle : more)
      scene.bench.obstacles_m.push_back(obstacle.outline_m());
    bench.renderer = std::make_shared<const imaging::SceneRenderer>(imaging::draw_scene(scene, seed));
  }
  return bench;
}

SeenBench Sensing::calibrated_bench(std::uint64_t seed) const {
  SeenBench bench = new_bench(seed);
  if (by_camera()) {
    common::RandomStream random(seed, "image for calibration");
    const imaging::RenderedFrame frame = bench.renderer->render({}, random);
    bench.calibration = imaging::calibrate_from_dish({frame.image}, config_.scene.bench, config_.scene.lens,
                                                     config_.camera.calibration);
  }
  return bench;
}

std::unique_ptr<RigSensor> Sensing::make(rig::VirtualRig& rig, const SeenBench& bench,
                                         common::RandomStream noise, common::Clock* clock,
                                         Images images) const {
  return std::make_unique<RigSensor>(rig, config_, segmenter_, bench, noise, clock, images);
}

}  // namespace lodestone::session
