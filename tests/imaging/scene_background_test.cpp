#include "scene_background.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "paper_scenes.h"

using namespace lodestone;
using namespace lodestone::imaging;

TEST_CASE("the layers of a scene are of the image's size, and every pixel knows its point of the floor") {
  const Scene scene = draw_scene(tests::paper_scenes(), 4);
  const SceneLayers layers = paint_layers(scene);
  const cv::Size size(static_cast<int>(scene.camera.width_px), static_cast<int>(scene.camera.height_px));
  for (const cv::Mat* layer : {&layers.floor_m, &layers.under, &layers.over, &layers.glare, &layers.plain})
    CHECK(layer->size() == size);
  const auto at = layers.floor_m.at<cv::Vec2f>(200, 300);
  CHECK((geometry::Vector2(at[0], at[1]) - scene.camera.to_dish({300.0, 200.0})).norm() < 1e-6);
}

TEST_CASE("light falls off towards the corners as far as the scene says") {
  Scene scene = draw_scene(tests::paper_scenes(), 4);
  scene.vignetting = 0.0;
  CHECK(light_at(scene, 0.0, 0.0) == Approx(light_at(scene, 600.0, 500.0)));
  scene.vignetting = 0.2;
  CHECK(light_at(scene, 0.0, 0.0) < 0.9F * light_at(scene, 639.5, 511.5));
}

TEST_CASE("what lies above hides what lies below, and glare brightens both") {
  SceneLayers layers;
  layers.under = cv::Mat(1, 3, CV_8UC3, cv::Scalar(100, 100, 100));
  layers.over = cv::Mat::zeros(1, 3, CV_8UC3);
  layers.over_alpha = (cv::Mat_<unsigned char>(1, 3) << 0, 255, 0);
  layers.glare = (cv::Mat_<unsigned char>(1, 3) << 0, 0, 200);
  layers.over.at<cv::Vec3b>(0, 1) = {7, 8, 9};
  cv::Mat image(1, 3, CV_8UC3);
  compose(layers, layers.under, {0, 0, 3, 1}, image);
  CHECK(image.at<cv::Vec3b>(0, 0) == cv::Vec3b(100, 100, 100));
  CHECK(image.at<cv::Vec3b>(0, 1) == cv::Vec3b(7, 8, 9));
  CHECK(image.at<cv::Vec3b>(0, 2) == cv::Vec3b(255, 255, 255));
}
