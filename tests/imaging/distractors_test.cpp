#include "distractors.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "paper_scenes.h"

using namespace lodestone;
using namespace lodestone::imaging;

TEST_CASE("stains and scratches lie below a needle, bubbles above it, and nothing is drawn unasked") {
  Scene scene = draw_scene(tests::paper_scenes(), 2);
  scene.stains = scene.scratches = scene.threads = scene.bubbles = 0;
  const auto draw = [&] {
    SceneLayers layers;
    const cv::Size size(static_cast<int>(scene.camera.width_px), static_cast<int>(scene.camera.height_px));
    layers.under = cv::Mat(size, CV_8UC3, cv::Scalar(128, 128, 128));
    layers.over = cv::Mat::zeros(size, CV_8UC3);
    layers.over_alpha = cv::Mat::zeros(size, CV_8U);
    common::RandomStream random(1, "distractors");
    draw_distractors(scene, random, layers);
    return layers;
  };
  const auto below = [](const SceneLayers& layers) {
    return cv::countNonZero(layers.under.reshape(1) != 128);
  };
  CHECK(below(draw()) == 0);
  CHECK(cv::countNonZero(draw().over_alpha) == 0);
  SECTION("stains") {
    scene.stains = 5;
    CHECK(below(draw()) > 100);
    CHECK(cv::countNonZero(draw().over_alpha) == 0);
  }
  SECTION("scratches") {
    scene.scratches = 10;
    CHECK(below(draw()) > 100);
  }
  SECTION("bubbles") {
    scene.bubbles = 8;
    CHECK(cv::countNonZero(draw().over_alpha) > 100);
  }
}
