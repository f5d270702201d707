#include "dish_search.h"

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "lodestone/imaging/calibration.h"
#include "lodestone/imaging/scene_renderer.h"
#include "paper_scenes.h"

using namespace lodestone;

TEST_CASE("a dish is found to a few pixels from the nominal mounting, however the camera hangs") {
  imaging::SceneConfig config = tests::paper_scenes();
  config.camera_tilt_deg = {-5.0, 5.0};
  for (const std::uint64_t seed : {1, 2, 3}) {
    const imaging::SceneRenderer renderer(imaging::draw_scene(config, seed));
    common::RandomStream random(1, "image");
    cv::Mat grey;
    cv::cvtColor(renderer.render({}, random).image, grey, cv::COLOR_BGR2GRAY);
    cv::Mat_<float> image;
    grey.convertTo(image, CV_32F);
    const imaging::CameraModel start = imaging::nominal_camera(config.lens);
    const imaging::CameraModel found = imaging::search_dish(image, config.bench, start);
    CAPTURE(seed);
    CHECK(imaging::floor_error(found, renderer.scene().camera, config.bench).rms_m < 1e-3);
    CHECK(found.focal_px == start.focal_px);
  }
}
