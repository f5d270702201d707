#include "lodestone/rig/video_camera.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "camera_conformance.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/files.h"
#include "lodestone/rig/aravis_camera.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

/// A device that gives an image whenever the test asks it to, and hangs otherwise.
class HandDriven {
 public:
  rig::VideoCamera::Reader reader() {
    return [this](cv::Mat& image) {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return closed_ || pending_ > 0; });
      if (closed_) return false;
      --pending_;
      image.create(48, 64, CV_8UC3);
      image.setTo(cv::Scalar::all(++shown_));
      return true;
    };
  }
  void show(int images) {
    change([&] { pending_ += images; });
  }
  void close() {
    change([&] { closed_ = true; });
  }

 private:
  template <class Change>
  void change(const Change& apply) {
    const std::lock_guard<std::mutex> lock(mutex_);
    apply();
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  int pending_ = 0;
  int shown_ = 0;
  bool closed_ = false;
};

bool steady_image(cv::Mat& image) {
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  image.create(48, 64, CV_8UC3);
  image.setTo(cv::Scalar::all(90));
  return true;
}

}  // namespace

TEST_CASE("a camera that is read by a thread keeps the contract of Camera") {
  rig::VideoCamera camera(steady_image, "device", 0.0);
  tests::check_camera(camera);
}

TEST_CASE("a device that hangs does not hang the caller, and an image is handed out once") {
  HandDriven device;
  {
    rig::VideoCamera camera(device.reader(), "device", 0.0);
    tests::check_silent_camera(camera);
    device.show(1);
    CHECK(camera.grab(10.0).image.at<cv::Vec3b>(0, 0)[0] == 1);
    CHECK_THROWS_WITH(camera.grab(0.01), Contains("device") && Contains("no image within 0.01 s"));
    device.show(1);
    CHECK(camera.grab(10.0).image.at<cv::Vec3b>(0, 0)[0] == 2);
    device.close();
    CHECK_THROWS_WITH(camera.grab(10.0), Contains("delivers no more images"));
    CHECK_THROWS_AS(camera.grab(10.0), common::HardwareError);
  }
}

TEST_CASE("stamps are those of the middle of the exposure") {
  HandDriven device;
  rig::VideoCamera camera(device.reader(), "device", 5.0);
  const double before_s = common::SteadyClock().now_s();
  device.show(1);
  const double stamp_s = camera.grab(10.0).stamp_s;
  CHECK(stamp_s >= before_s - 5.0);
  CHECK(stamp_s <= common::SteadyClock().now_s() - 5.0);
  device.close();
}

TEST_CASE("a driver's exception reaches the caller as a camera that failed") {
  rig::VideoCamera camera([](cv::Mat&) -> bool { throw std::runtime_error("bus reset"); }, "device", 0.0);
  CHECK_THROWS_WITH(camera.grab(10.0), Contains("bus reset"));
}

TEST_CASE("a device that is missing or no device is named, with what to do") {
  rig::CameraSourceConfig config;
  config.kind = rig::CameraKind::kUvc;
  config.source = "9173";
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("/dev/video9173") && Contains("devices present"));
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "film.avi", "x");
  config.source = folder / "film.avi";
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("is not a device"));
  config.source = "/dev/null";  // a device, but no camera
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("cannot open /dev/null"));
}

TEST_CASE("camera settings are read strictly") {
  const auto read = [](const char* text) {
    return common::config_from_json<rig::CameraSourceConfig>(common::Json::parse(text), "rig.json");
  };
  CHECK(read(R"({"kind": "uvc", "source": "0"})").width_px == 1280);
  CHECK_THROWS_WITH(read(R"({"kind": "webcam"})"), Contains("kind") && Contains("webcam"));
  CHECK_THROWS_WITH(read(R"({"frame_rate_hz": 0})"), Contains("frame_rate_hz"));
}

TEST_CASE("a build without Aravis names the package") {
  if (rig::AravisCamera::available()) return;
  rig::CameraSourceConfig config;
  config.kind = rig::CameraKind::kGenicam;
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("libaravis-dev"));
}
