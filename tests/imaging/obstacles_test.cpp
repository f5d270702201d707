#include "obstacles.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core.hpp>

#include "paper_scenes.h"

using namespace lodestone;
using namespace lodestone::imaging;

TEST_CASE("obstacles are painted in their grey where they stand, and nothing else is") {
  Scene scene = draw_scene(tests::paper_scenes(), 2);
  scene.obstacle_grey = 0.2;
  scene.cast = {1.0F, 1.0F, 1.0F};
  SceneLayers layers;
  const cv::Size size(static_cast<int>(scene.camera.width_px), static_cast<int>(scene.camera.height_px));
  const auto draw = [&] {
    layers.under = cv::Mat(size, CV_8UC3, cv::Scalar(200, 200, 200));
    draw_obstacles(scene, layers);
  };
  const auto seen_at = [&](double x_m, double y_m) {
    const Eigen::Vector2d pixel = scene.camera.project_floor({x_m, y_m});
    return layers.under.at<cv::Vec3b>(static_cast<int>(std::lround(pixel.y())),
                                      static_cast<int>(std::lround(pixel.x())));
  };
  draw();
  CHECK(cv::countNonZero(layers.under.reshape(1) != 200) == 0);

  // An L of 10 mm, 4 mm wide.
  scene.bench.obstacles_m = {
      {{0.0, 0.0}, {0.01, 0.0}, {0.01, 0.004}, {0.004, 0.004}, {0.004, 0.01}, {0.0, 0.01}}};
  draw();
  for (const geometry::Vector2& inside_m :
       {geometry::Vector2(0.002, 0.008), geometry::Vector2(0.008, 0.002)}) {
    const Eigen::Vector2d pixel = scene.camera.project_floor(inside_m);
    const double expected = 255.0 * 0.2 * light_at(scene, pixel.x(), pixel.y());
    CHECK(seen_at(inside_m.x(), inside_m.y())[1] == Approx(expected).margin(1.5));
  }
  CHECK(seen_at(0.008, 0.008) == cv::Vec3b(200, 200, 200));
  CHECK(seen_at(-0.002, 0.005) == cv::Vec3b(200, 200, 200));
  const double pixel_m = scene.camera.pixel_size_m();
  CHECK(cv::countNonZero(layers.under.reshape(1) != 200) / 3.0 * pixel_m * pixel_m ==
        Approx(64e-6).epsilon(0.2));
}
