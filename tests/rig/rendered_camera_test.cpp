#include "lodestone/rig/rendered_camera.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "camera_conformance.h"
#include "lodestone/common/error.h"
#include "paper_scenes.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

std::shared_ptr<const imaging::SceneRenderer> renderer_of(double noise_grey = 2.0) {
  imaging::SceneConfig config = tests::paper_scenes();
  config.bench = rig::bench_of({});
  imaging::Scene scene = imaging::draw_scene(config, 1);
  scene.noise_grey = noise_grey;
  scene.exposure_s = 0.008;
  return std::make_shared<const imaging::SceneRenderer>(scene);
}

}  // namespace

TEST_CASE("the rendered camera keeps the contract of Camera") {
  rig::VirtualRig rig({}, 1);
  rig::RenderedCamera camera(rig, renderer_of(), common::RandomStream(1, "noise"));
  tests::check_camera(camera);
  CHECK_THROWS_AS(camera.grab(0.001), common::HardwareError);  // shorter than the exposure
}

TEST_CASE("of a sphere a camera sees a disc, and no tape") {
  CHECK_FALSE(rig::bench_of({}).sphere);
  const imaging::BenchGeometry bench = rig::bench_of(tests::sphere_rig());
  CHECK(bench.sphere);
  CHECK(bench.tape_length_m == 0.0);
  CHECK(bench.needle_diameter_m == 3e-3);
}

TEST_CASE("an image takes its exposure on the rig's clock and shows where the needle is") {
  rig::VirtualRig rig({}, 1);
  rig::RenderedCamera camera(rig, renderer_of(0.0), common::RandomStream(1, "noise"));
  rig.place({0.01, 0.0, 0.0});
  const double start_s = rig.clock().now_s();
  const imaging::Frame here = camera.grab(1.0);
  CHECK(rig.clock().now_s() == Approx(start_s + 0.008));
  CHECK(here.stamp_s == Approx(start_s + 0.004));
  rig.place({-0.01, 0.0, 0.0});
  const imaging::Frame there = camera.grab(1.0);
  cv::Mat difference;
  cv::absdiff(here.image, there.image, difference);
  CHECK(cv::countNonZero(difference.reshape(1) > 40) > 1000);
}

TEST_CASE("obstacles that the virtual rig hides are in its camera's images alone") {
  rig::VirtualRigConfig config;
  physics::ObstacleConfig obstacle;
  obstacle.centre_m = {0.0, 0.02};
  obstacle.radius_m = 5e-3;
  config.simulation.obstacles = {obstacle};
  CHECK(rig::bench_of(config).obstacles_m.empty());
  const imaging::BenchGeometry bench = rig::rendered_bench_of(config);
  REQUIRE(bench.obstacles_m.size() == 1);
  for (const geometry::Vector2& point_m : bench.obstacles_m[0])
    CHECK((point_m - geometry::Vector2(0.0, 0.02)).norm() == Approx(5e-3));
  CHECK(bench.dish_radius_m == config.dish.radius_m);

  imaging::SceneConfig scenes = tests::paper_scenes();
  scenes.stains = scenes.threads = scenes.bubbles = {0.0, 0.0};
  scenes.glare = {0.0, 0.0};
  scenes.bench = bench;
  const auto renderer = std::make_shared<const imaging::SceneRenderer>(imaging::draw_scene(scenes, 1));
  rig::VirtualRig rig(config, 1);
  rig::RenderedCamera camera(rig, renderer, common::RandomStream(1, "noise"));
  const cv::Mat image = camera.grab(1.0).image;
  const auto brightness_at = [&](double x_m, double y_m) {
    const Eigen::Vector2d pixel = renderer->scene().camera.project_floor({x_m, y_m});
    const cv::Rect around(static_cast<int>(pixel.x()) - 5, static_cast<int>(pixel.y()) - 5, 10, 10);
    return cv::mean(image(around))[1];
  };
  CHECK(brightness_at(0.0, 0.02) < 0.6 * brightness_at(0.0, -0.02));
}

TEST_CASE("the bench in the image has the rig's sizes") {
  rig::VirtualRigConfig config;
  config.needle.length_m = 0.018;
  config.dish.radius_m = 0.04;
  const imaging::BenchGeometry bench = rig::bench_of(config);
  CHECK(bench.needle_length_m == 0.018);
  CHECK(bench.dish_radius_m == 0.04);
  CHECK(bench.coil_face_m == Approx(0.05));
}
