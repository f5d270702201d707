#include "lodestone/imaging/calibration_overlay.h"

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "lodestone/imaging/scene_renderer.h"
#include "paper_scenes.h"

using namespace lodestone;

TEST_CASE("the overlay draws what the calibration says, and nothing else") {
  const imaging::SceneConfig config = tests::paper_scenes();
  const imaging::SceneRenderer renderer(imaging::draw_scene(config, 1));
  common::RandomStream random(1, "image");
  const cv::Mat image = renderer.render({}, random).image;
  const cv::Mat overlay = imaging::calibration_overlay(image, renderer.scene().camera, config.bench);
  cv::Mat difference;
  cv::absdiff(image, overlay, difference);
  const int changed = cv::countNonZero(difference.reshape(1));
  CHECK(changed > 10000);
  CHECK(changed < 0.1 * static_cast<double>(difference.total() * 3));
}
