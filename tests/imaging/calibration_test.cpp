#include "lodestone/imaging/calibration.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"
#include "lodestone/imaging/scene_renderer.h"
#include "paper_scenes.h"

using namespace lodestone;

namespace {

/// Camera up to 5 mm and 5 degrees off.
imaging::SceneConfig far_off() {
  imaging::SceneConfig config = tests::paper_scenes();
  config.camera_tilt_deg = {-5.0, 5.0};
  config.camera_turn_deg = {-5.0, 5.0};
  return config;
}

cv::Mat image_of(const imaging::SceneRenderer& renderer, bool with_needle = false) {
  common::RandomStream random(1, "image");
  std::vector<imaging::NeedleView> needles;
  if (with_needle) needles.push_back({{0.01, -0.02, 0.5}});
  return renderer.render(needles, random).image;
}

}  // namespace

TEST_CASE("a camera 5 mm and 5 degrees off is calibrated from one image of the dish") {
  const imaging::SceneConfig config = far_off();
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const imaging::SceneRenderer renderer(imaging::draw_scene(config, seed));
    const imaging::Calibration calibration =
        imaging::calibrate_from_dish({image_of(renderer, seed % 2 == 0)}, config.bench, config.lens);
    const imaging::FloorError error =
        imaging::floor_error(calibration.camera, renderer.scene().camera, config.bench);
    CAPTURE(seed);
    CHECK(error.rms_m < 0.15e-3);
    CHECK(error.max_m < 0.3e-3);
    CHECK(calibration.reprojection_rms_m < 0.05e-3);
  }
}

TEST_CASE("a fluid that is told of is looked through; one that is not bends the dish") {
  imaging::SceneConfig wet = far_off();
  wet.bench.fluid_depth_m = 0.0053;
  wet.bench.refractive_index = 1.36;
  double told_m = 0.0, untold_m = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const imaging::SceneRenderer renderer(imaging::draw_scene(wet, seed));
    const cv::Mat image = image_of(renderer);
    const auto error_m = [&](const imaging::BenchGeometry& bench) {
      const imaging::CameraModel found = imaging::calibrate_from_dish({image}, bench, wet.lens).camera;
      return imaging::floor_error(found, renderer.scene().camera, wet.bench).rms_m;
    };
    told_m += error_m(wet.bench) / 4.0;
    untold_m += error_m(far_off().bench) / 4.0;
  }
  CAPTURE(told_m, untold_m);
  CHECK(told_m < 0.1e-3);
  CHECK(untold_m > 1.5 * told_m);
}

TEST_CASE("known intrinsics are left as they are") {
  const imaging::SceneConfig config = far_off();
  const imaging::SceneRenderer renderer(imaging::draw_scene(config, 11));
  imaging::CameraModel start = imaging::nominal_camera(config.lens);
  start.k1 = renderer.scene().camera.k1;
  const imaging::DishFit fit = imaging::fit_dish({image_of(renderer)}, config.bench, start, {}, true);
  CHECK(fit.calibration.camera.focal_px == start.focal_px);
  CHECK(fit.calibration.camera.k1 == start.k1);
  CHECK(imaging::floor_error(fit.calibration.camera, renderer.scene().camera, config.bench).rms_m < 0.15e-3);
}

TEST_CASE("a camera that was knocked is noticed, one that was not is left alone") {
  const imaging::SceneConfig config = far_off();
  imaging::Scene scene = imaging::draw_scene(config, 3);
  const imaging::SceneRenderer before(scene);
  const imaging::Calibration calibration =
      imaging::calibrate_from_dish({image_of(before)}, config.bench, config.lens);
  const imaging::CalibrationConfig bounds;
  CHECK(imaging::camera_moved_m(image_of(before, true), calibration, config.bench) < bounds.moved_bound_m);
  scene.camera = imaging::moved(scene.camera, {0.0, 0.0, 0.0}, {0.001, 0.0, 0.0});
  const imaging::SceneRenderer after(scene);
  CHECK(imaging::camera_moved_m(image_of(after), calibration, config.bench) > bounds.moved_bound_m);
}

TEST_CASE("what cannot be calibrated is named") {
  const imaging::SceneConfig config = far_off();
  const auto refuse = [&](const cv::Mat& image) {
    imaging::calibrate_from_dish({image}, config.bench, config.lens);
  };
  CHECK_THROWS_AS(refuse(cv::Mat(1024, 1280, CV_8UC3, cv::Scalar::all(120))), common::DataError);
  CHECK_THROWS_WITH(refuse(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(120))), Catch::Contains("640 x 480"));
  CHECK_THROWS_AS(imaging::calibrate_from_dish({}, config.bench, config.lens), common::DataError);
  cv::Mat noise(1024, 1280, CV_8UC3);
  cv::randu(noise, 0, 255);
  CHECK_THROWS_AS(refuse(noise), common::DataError);
}
