#include "lodestone/imaging/scene.h"

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lodestone::imaging {

namespace {

/// Hue in degrees, saturation and value in [0, 1].
Colour from_hsv(double hue_deg, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue_deg / 60.0, 6.0);
    return static_cast<float>(value - value * saturation * std::max(0.0, std::min({k, 4.0 - k, 1.0})));
  };
  return {channel(1.0), channel(3.0), channel(5.0)};
}

}  // namespace

CameraModel nominal_camera(const LensConfig& lens) {
  CameraModel camera;
  camera.width_px = lens.width_px;
  camera.height_px = lens.height_px;
  camera.focal_px = lens.focal_px;
  camera.centre_u_px = 0.5 * static_cast<double>(lens.width_px - 1);
  camera.centre_v_px = 0.5 * static_cast<double>(lens.height_px - 1);
  camera.translation_m = {0.0, 0.0, lens.distance_m};
  return camera;
}

FluidLayer fluid_of(const BenchGeometry& bench) {
  if (bench.fluid_depth_m <= 0.0) return {};
  // Up to the middle of the wall: its foot is seen through the fluid, too.
  return {bench.fluid_depth_m, bench.dish_radius_m + 0.5 * bench.wall_thickness_m, bench.refractive_index};
}

SceneConfig widened(SceneConfig config, double fraction) {
  struct Widener {
    double fraction;
    void field(const char*, common::Range& range, const char*, const char*, common::Bounds bounds) {
      const double extra = 0.5 * fraction * (range.high - range.low);
      range = {std::max(range.low - extra, bounds.min), std::min(range.high + extra, bounds.max)};
    }
    void group(const char*, LensConfig&, const char*) {}
    void retired(const char*, const char*) {}
  } widener{fraction};
  config.visit(widener);
  return config;
}

Scene draw_scene(const SceneConfig& config, std::uint64_t seed) {
  LODESTONE_CHECK(config.bench.dish_radius_m > 0.0, "a scene needs the sizes of a rig");
  common::RandomStream random(seed, "scene");
  Scene scene;
  scene.seed = seed;
  scene.bench = config.bench;
  const Eigen::Vector3d turn(geometry::kRadPerDeg * config.camera_tilt_deg.draw(random),
                             geometry::kRadPerDeg * config.camera_tilt_deg.draw(random),
                             geometry::kRadPerDeg * config.camera_turn_deg.draw(random));
  const Eigen::Vector3d shift(config.camera_shift_m.draw(random), config.camera_shift_m.draw(random),
                              config.camera_rise_m.draw(random));
  scene.camera = moved(nominal_camera(config.lens), turn, shift);
  scene.camera.k1 = config.lens_k1.draw(random);
  scene.camera.fluid = fluid_of(config.bench);
  scene.brightness = config.brightness.draw(random);
  for (float& gain : scene.cast) gain = static_cast<float>(config.colour_cast.draw(random));
  scene.vignetting = config.vignetting.draw(random);
  scene.floor_grey = config.floor_grey.draw(random);
  scene.fluid_tint = config.fluid_tint.draw(random);
  scene.glare = config.glare.draw(random);
  scene.needle_grey = config.needle_grey.draw(random);
  scene.needle_shine = config.needle_shine.draw(random);
  const double hue_deg = config.tape_hue_deg.draw(random);
  const double saturation = config.tape_saturation.draw(random);
  scene.tape = from_hsv(hue_deg, saturation, config.tape_value.draw(random));
  scene.blur_px = config.blur_px.draw(random);
  scene.exposure_s = config.exposure_s.draw(random);
  scene.noise_grey = config.noise_grey.draw(random);
  const auto count = [&random](const common::Range& range) {
    return static_cast<int>(std::lround(range.draw(random)));
  };
  scene.threads = count(config.threads);
  scene.bubbles = count(config.bubbles);
  scene.scratches = count(config.scratches);
  scene.stains = count(config.stains);
  scene.obstacle_grey = config.obstacle_grey.draw(random);
  return scene;
}

}  // namespace lodestone::imaging
