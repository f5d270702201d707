#include "lodestone/rig/driver_camera.h"

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>

#include "camera_conformance.h"
#include "fake_driver.h"

using namespace lodestone;
using common::Json;

namespace {

rig::DriverReply image(const char* format, std::vector<std::uint8_t> bytes) {
  return {{{"format", format}, {"width_px", 32}, {"height_px", 16}, {"age_s", 0.01}, {"bytes", bytes.size()}},
          bytes};
}

}  // namespace

TEST_CASE("a driver is a camera, and a silent one says so") {
  tests::FakeDriver driver;
  driver.other = [](const Json&) { return image("bgr8", std::vector<std::uint8_t>(32 * 16 * 3, 7)); };
  rig::DriverCamera camera(driver.open(), 1.0);
  tests::check_camera(camera);
  const double before_s = common::SteadyClock().now_s();
  const double stamp_s = camera.grab(1.0).stamp_s;
  CHECK(stamp_s >= before_s - 0.01);
  CHECK(stamp_s <= common::SteadyClock().now_s() - 0.01);
  driver.hangs = true;
  tests::check_silent_camera(camera);
}

TEST_CASE("images of every format, and what is none") {
  CHECK(rig::driver_image(image("gray8", std::vector<std::uint8_t>(32 * 16, 9))).at<cv::Vec3b>(3, 4) ==
        cv::Vec3b(9, 9, 9));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", cv::Mat(16, 32, CV_8UC3, cv::Scalar(1, 2, 3)), bytes);
  CHECK(rig::driver_image(image("png", bytes)).at<cv::Vec3b>(0, 0) == cv::Vec3b(1, 2, 3));
  CHECK_THROWS_WITH(rig::driver_image(image("jpeg", {1, 2, 3})), Catch::Contains("is no jpeg of any kind"));
  CHECK_THROWS_WITH(rig::driver_image(image("jpeg", {})), Catch::Contains("is no jpeg of any kind"));
  CHECK_THROWS_WITH(rig::driver_image(image("bgr8", {1, 2, 3})),
                    Catch::Contains("has 3 bytes, 1536 belong there"));
  CHECK_THROWS_WITH(rig::driver_image(image("rgb16", {})),
                    Catch::Contains("format = \"rgb16\", it must be bgr8, gray8, jpeg or png"));
}

TEST_CASE("a camera's address is one of a driver") {
  rig::CameraSourceConfig config;
  config.kind = rig::CameraKind::kDriver;
  config.source = "/dev/video0";
  CHECK_THROWS_WITH(rig::open_camera(config), Catch::Contains("rig.camera.source = \"/dev/video0\" must be"));
}
