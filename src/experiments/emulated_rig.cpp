#include "lodestone/experiments/emulated_rig.h"

#include "lodestone/rig/rendered_camera.h"

namespace lodestone::experiments {

EmulatedRig make_emulated_rig(const rig::RigConfig& rig, std::uint64_t seed,
                              const imaging::SceneConfig* scene, std::uint64_t scene_seed) {
  std::shared_ptr<const imaging::SceneRenderer> renderer;
  if (scene != nullptr) {
    imaging::SceneConfig of_rig = *scene;
    of_rig.bench = rig::rendered_bench_of(rig);
    renderer = std::make_shared<const imaging::SceneRenderer>(imaging::draw_scene(of_rig, scene_seed));
  }
  EmulatedRig made{std::make_unique<emulation::LiveBench>(rig, seed, renderer), rig};
  made.description.backend = rig::Backend::kSerial;
  made.description.serial.port = made.bench->port();
  if (renderer) {
    rig::CameraSourceConfig& camera = made.description.camera;
    camera.kind = rig::CameraKind::kGenicam;
    camera.source = made.bench->camera();
    camera.serial = made.bench->camera_serial();
    camera.pixel_format = "RGB8";
    camera.width_px = renderer->scene().camera.width_px;
    camera.height_px = renderer->scene().camera.height_px;
    camera.frame_rate_hz = 20.0;
  }
  return made;
}

}  // namespace lodestone::experiments
