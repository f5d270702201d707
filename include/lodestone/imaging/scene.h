#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/common/range.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"

namespace lodestone::imaging {

/// The camera as it was meant to be mounted.
struct LensConfig {
  std::int64_t width_px = 1280;
  std::int64_t height_px = 1024;
  double focal_px = 4717.0;    // D: 25 mm lens, pixels of 5.3 um
  double distance_m = 0.4717;  // D: 0.1 mm per pixel (rig-physics.md)

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("width_px", width_px, "px", "width of the image", {64, 16384});
    v.field("height_px", height_px, "px", "height of the image", {64, 16384});
    v.field("focal_px", focal_px, "px", "focal length over pixel size", {50.0, 1e6});
    v.field("distance_m", distance_m, "m", "from the dish floor to the lens", {0.02, 10.0});
  }
};

CameraModel nominal_camera(const LensConfig& lens);
/// What a camera sees the floor of a bench through.
FluidLayer fluid_of(const BenchGeometry& bench);

/// What may differ from one bench, day or image to the next. Every factor is drawn uniformly from its
/// range.
struct SceneConfig {
  LensConfig lens;
  BenchGeometry bench;  ///< no key: its sizes are the rig's
  common::Range camera_shift_m{-0.005, 0.005};
  common::Range camera_rise_m{-0.005, 0.005};
  common::Range camera_tilt_deg{-3.0, 3.0};
  common::Range camera_turn_deg{-5.0, 5.0};
  common::Range lens_k1{-0.6, 0.6};
  common::Range brightness{0.85, 1.15};
  common::Range colour_cast{0.92, 1.08};
  common::Range vignetting{0.0, 0.25};
  common::Range floor_grey{0.55, 0.80};
  common::Range fluid_tint{0.0, 0.08};
  common::Range glare{0.0, 0.35};
  common::Range needle_grey{0.22, 0.42};
  common::Range needle_shine{0.1, 0.5};
  common::Range tape_hue_deg{70.0, 140.0};
  common::Range tape_saturation{0.65, 1.0};
  common::Range tape_value{0.6, 1.0};
  common::Range blur_px{0.5, 1.2};
  common::Range exposure_s{0.005, 0.010};
  common::Range noise_grey{1.0, 4.0};
  common::Range threads{0.0, 2.0};
  common::Range bubbles{0.0, 8.0};
  common::Range scratches{0.0, 10.0};
  common::Range stains{0.0, 3.0};
  common::Range obstacle_grey{0.05, 0.2};

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("lens", lens, "the camera as it was meant to be mounted");
    v.retired("bench", "rig");
    v.field("camera_shift_m", camera_shift_m, "m", "sideways error of the camera's place", {-0.1, 0.1});
    v.field("camera_rise_m", camera_rise_m, "m", "error of the camera's height", {-0.1, 0.1});
    v.field("camera_tilt_deg", camera_tilt_deg, "deg", "tilt about x and about y", {-45.0, 45.0});
    v.field("camera_turn_deg", camera_turn_deg, "deg", "rotation of the image", {-40.0, 40.0});
    v.field("lens_k1", lens_k1, "", "radial distortion of the lens", {-5.0, 5.0});
    v.field("brightness", brightness, "", "gain of the whole image", {0.05, 5.0});
    v.field("colour_cast", colour_cast, "", "gain of each colour", {0.3, 3.0});
    v.field("vignetting", vignetting, "", "loss of light at the corners", {0.0, 0.9});
    v.field("floor_grey", floor_grey, "", "brightness of the dish floor, 1 is white", {0.0, 1.0});
    v.field("fluid_tint", fluid_tint, "", "depth of the fluid's colour", {0.0, 0.5});
    v.field("glare", glare, "", "strength of the ring light's reflection", {0.0, 1.0});
    v.field("needle_grey", needle_grey, "", "brightness of the steel", {0.0, 1.0});
    v.field("needle_shine", needle_shine, "", "strength of the streak of light along the needle", {0.0, 1.0});
    v.field("tape_hue_deg", tape_hue_deg, "deg", "hue of the tape on the needle's head", {0.0, 360.0});
    v.field("tape_saturation", tape_saturation, "", "saturation of the tape", {0.0, 1.0});
    v.field("tape_value", tape_value, "", "brightness of the tape", {0.0, 1.0});
    v.field("blur_px", blur_px, "px", "standard deviation of the optical blur", {0.0, 10.0});
    v.field("exposure_s", exposure_s, "s", "exposure; what moves is smeared", {1e-5, 1.0});
    v.field("noise_grey", noise_grey, "grey levels", "standard deviation of the sensor's noise, of 255",
            {0.0, 12.0});
    v.field("threads", threads, "", "number of suture threads", {0.0, 20.0});
    v.field("bubbles", bubbles, "", "number of bubbles", {0.0, 200.0});
    v.field("scratches", scratches, "", "number of scratches of the dish", {0.0, 200.0});
    v.field("stains", stains, "", "number of blood-like stains on the floor", {0.0, 50.0});
    v.field("obstacle_grey", obstacle_grey, "",
            "brightness of the obstacles that a virtual rig has, 1 is white", {0.0, 1.0});
  }
};

/// Every range longer by `fraction` of its length, half of it on either side, as far as the keys' bounds
/// allow.
SceneConfig widened(SceneConfig config, double fraction);

/// Colour as blue, green, red, 1 is white.
using Colour = std::array<float, 3>;

/// One bench in front of one camera: every factor drawn.
struct Scene {
  std::uint64_t seed = 0;
  BenchGeometry bench;
  CameraModel camera;
  double brightness = 1.0;
  Colour cast{1.0F, 1.0F, 1.0F};
  double vignetting = 0.0;
  double floor_grey = 0.7;
  double fluid_tint = 0.0;
  double glare = 0.0;
  double needle_grey = 0.3;
  double needle_shine = 0.3;
  Colour tape{0.1F, 1.0F, 0.3F};
  double blur_px = 0.8;
  double exposure_s = 0.008;
  double noise_grey = 2.0;
  int threads = 0;
  int bubbles = 0;
  int scratches = 0;
  int stains = 0;
  double obstacle_grey = 0.1;
};

/// The same seed always gives the same scene.
Scene draw_scene(const SceneConfig& config, std::uint64_t seed);

}  // namespace lodestone::imaging
