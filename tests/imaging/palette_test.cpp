#include "palette.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using lodestone::imaging::Palette;

TEST_CASE("few colours are kept as they are") {
  cv::Mat image(2, 2, CV_8UC3, cv::Scalar(10, 20, 30));
  image.at<cv::Vec3b>(0, 1) = {200, 100, 50};
  const Palette palette(image, cv::Mat(2, 2, CV_8UC1, cv::Scalar(255)), 16);
  REQUIRE(palette.colours().size() == 2);
  CHECK(palette.colours()[palette.index_of({10, 20, 30})] == cv::Vec3b(10, 20, 30));
  CHECK(palette.colours()[palette.index_of({200, 100, 50})] == cv::Vec3b(200, 100, 50));
}

TEST_CASE("a ramp is cut into even parts, each colour the mean of its part") {
  cv::Mat ramp(1, 256, CV_8UC3);
  for (int i = 0; i < 256; ++i) ramp.at<cv::Vec3b>(0, i) = cv::Vec3b(static_cast<std::uint8_t>(i), 0, 0);
  const Palette palette(ramp, cv::Mat(1, 256, CV_8UC1, cv::Scalar(1)), 4);
  REQUIRE(palette.colours().size() == 4);
  for (int i = 0; i < 256; ++i) {
    const int shown = palette.colours()[palette.index_of(ramp.at<cv::Vec3b>(0, i))][0];
    CHECK(std::abs(shown - i) <= 32);
  }
}

TEST_CASE("pixels outside the mask do not count") {
  cv::Mat image(1, 3, CV_8UC3, cv::Scalar(0, 0, 0));
  image.at<cv::Vec3b>(0, 2) = {255, 255, 255};
  cv::Mat mask = cv::Mat::zeros(1, 3, CV_8UC1);
  CHECK(Palette(image, mask, 8).colours().empty());
  mask.at<std::uint8_t>(0, 2) = 255;
  const Palette palette(image, mask, 8);
  REQUIRE(palette.colours().size() == 1);
  CHECK(palette.colours()[0] == cv::Vec3b(255, 255, 255));
  CHECK_THROWS_AS(Palette(image, mask, 0), lodestone::common::LogicFault);
}
