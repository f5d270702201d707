#include "lodestone/imaging/frame_guard.h"

#include <catch2/catch.hpp>
#include <limits>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

imaging::FrameGuardConfig small() {
  imaging::FrameGuardConfig config;
  config.width_px = 64;
  config.height_px = 48;
  config.sample_step_px = 4;
  return config;
}

/// A grey image whose last pixel tells frames apart.
imaging::Frame image(double stamp_s, int last_pixel = 0, cv::Size size = {64, 48}, int type = CV_8UC3) {
  cv::Mat image(size, type, cv::Scalar::all(120));
  if (type == CV_8UC3) image.at<cv::Vec3b>(size.height - 1, size.width - 1)[2] = last_pixel & 0xff;
  return {image, stamp_s};
}

std::string refusal(imaging::FrameGuard& guard, const imaging::Frame& frame) {
  try {
    guard.check(frame);
  } catch (const common::HardwareError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a frame guard lets live images pass") {
  imaging::FrameGuard guard(small(), "camera");
  for (int i = 0; i < 5; ++i) CHECK_NOTHROW(guard.check(image(0.1 * i, i)));
}

TEST_CASE("a frame guard names what is wrong with an image, its bound and the remedy") {
  imaging::FrameGuard guard(small(), "top camera");
  CHECK_THAT(refusal(guard, {cv::Mat(), 1.0}), Contains("top camera") && Contains("empty"));
  CHECK_THAT(refusal(guard, image(1.0, 0, {64, 48}, CV_8UC1)),
             Contains("1 channel(s)") && Contains("must be 3"));
  CHECK_THAT(refusal(guard, image(1.0, 0, {64, 48}, CV_16UC3)), Contains("16 bits"));
  CHECK_THAT(refusal(guard, image(1.0, 0, {48, 64})), Contains("48x64") && Contains("must be 64x48"));
  CHECK_THAT(refusal(guard, image(std::numeric_limits<double>::quiet_NaN())), Contains("finite"));
}

TEST_CASE("a frame guard refuses overexposure above its bound only, and only where all channels clip") {
  imaging::FrameGuard guard(small(), "camera");
  imaging::Frame glare = image(1.0);
  glare.image.rowRange(0, 12).setTo(cv::Scalar::all(250));  // exactly 25 %
  CHECK_NOTHROW(guard.check(glare));
  imaging::Frame bright = image(2.0);
  bright.image.rowRange(0, 16).setTo(cv::Scalar::all(250));
  CHECK_THAT(refusal(guard, bright), Contains("33.3 %") && Contains("25.0 %") && Contains("exposure"));
  imaging::Frame yellow = image(3.0);
  yellow.image.setTo(cv::Scalar(40, 255, 255));
  CHECK_NOTHROW(guard.check(yellow));
}

TEST_CASE("a frame guard notices a frozen camera") {
  imaging::FrameGuard guard(small(), "camera");
  guard.check(image(1.0, 1));
  CHECK_THAT(refusal(guard, image(1.1, 1)), Contains("frozen") && Contains("same image twice"));
  CHECK_THAT(refusal(guard, image(1.0, 2)), Contains("frozen") && Contains("must be later"));
  CHECK_NOTHROW(guard.check(image(1.2, 2)));  // it goes on
  guard.reset();
  CHECK_NOTHROW(guard.check(image(0.0, 2)));
}
