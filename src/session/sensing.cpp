#include "lodestone/session/sensing.h"

#include "lodestone/common/error.h"

namespace lodestone::session {

RigSensor::RigSensor(rig::VirtualRig& rig, const SensingConfig& config,
                     std::shared_ptr<const vision::Segmenter> segmenter, const SeenBench& bench,
                     common::RandomStream noise, common::Clock* clock) {
  if (config.kind == "camera") {
    camera_.emplace(rig, bench.renderer, noise, clock);
    by_camera_.emplace(*camera_, std::move(segmenter), config.scene.bench, config.scene.lens, config.camera,
                       bench.calibration);
  } else {
    simulated_.emplace([&rig] { return rig.true_pose(); }, clock != nullptr ? *clock : rig.clock(),
                       config.simulated, draw_calibration_error(config.simulated, bench.seed), noise);
  }
}

control::PoseEstimate RigSensor::observe() {
  return by_camera_ ? by_camera_->observe() : simulated_->observe();
}

void RigSensor::reset() {
  if (by_camera_) by_camera_->reset();
  if (simulated_) simulated_->reset();
}

std::string RigSensor::save() const { return camera_ ? camera_->save() : simulated_->save(); }

void RigSensor::restore(const std::string& state) {
  if (camera_)
    camera_->restore(state);
  else
    simulated_->restore(state);
}

Sensing::Sensing(const SensingConfig& config, const rig::VirtualRigConfig& rig) : config_(config) {
  config_.scene.bench = rig::bench_of(rig);
  if (by_camera()) segmenter_ = vision::Segmenter::load(config.segmenter);
}

SeenBench Sensing::new_bench(std::uint64_t seed) const {
  SeenBench bench;
  bench.seed = seed;
  if (by_camera())
    bench.renderer = std::make_shared<const imaging::SceneRenderer>(imaging::draw_scene(config_.scene, seed));
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
                                         common::RandomStream noise, common::Clock* clock) const {
  return std::make_unique<RigSensor>(rig, config_, segmenter_, bench, noise, clock);
}

}  // namespace lodestone::session
