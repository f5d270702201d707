#include "lodestone/rig/video_camera.h"

#include <fmt/core.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <thread>
#include <utility>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"

namespace lodestone::rig {
namespace {

namespace fs = std::filesystem;

std::string device_path(const std::string& source) {
  const bool digits = !source.empty() && source.find_first_not_of("0123456789") == std::string::npos;
  return digits ? "/dev/video" + source : source;
}

std::string devices_present() {
  std::string found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev")) {
    const std::string path = entry.path().string();
    if (path.rfind("/dev/video", 0) == 0) found += (found.empty() ? "" : ", ") + path;
  }
  return found.empty() ? "none" : found;
}

/// OpenCV only says "cannot open"; this says why.
void check_device(const std::string& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw common::HardwareError("no camera at '" + path + "' (devices present: " + devices_present() +
                                "); plug it in, or set camera.source to its number or path");
  }
  if (!fs::is_character_file(path, ignored)) {
    throw common::HardwareError(path + " is not a device; for images and videos set camera.kind to files");
  }
  if (::access(path.c_str(), R_OK | W_OK) != 0) {
    throw common::HardwareError(
        "no permission to use " + path +
        "; add the user to the group video (sudo usermod -aG video $USER) and log in again");
  }
}

void set_property(cv::VideoCapture& capture, const std::string& path, int property, double value,
                  const std::string& what, const std::string& remedy) {
  if (!capture.set(property, value)) throw common::HardwareError(path + " refuses " + what + "; " + remedy);
}

void configure(cv::VideoCapture& capture, const std::string& path, const CameraSourceConfig& config) {
  if (!config.pixel_format.empty()) {
    if (config.pixel_format.size() != 4)
      throw common::ConfigError("pixel_format = '" + config.pixel_format +
                                "', must be four letters such as MJPG or YUYV for a USB camera");
    const std::string& f = config.pixel_format;
    set_property(capture, path, cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc(f[0], f[1], f[2], f[3]),
                 "pixel_format " + f, "see v4l2-ctl --list-formats");
  }
  capture.set(cv::CAP_PROP_FRAME_WIDTH, static_cast<double>(config.width_px));
  capture.set(cv::CAP_PROP_FRAME_HEIGHT, static_cast<double>(config.height_px));
  const auto width = std::lround(capture.get(cv::CAP_PROP_FRAME_WIDTH));
  const auto height = std::lround(capture.get(cv::CAP_PROP_FRAME_HEIGHT));
  if (width != config.width_px || height != config.height_px) {
    throw common::HardwareError(path + " gives " + std::to_string(width) + "x" + std::to_string(height) +
                                " instead of " + std::to_string(config.width_px) + "x" +
                                std::to_string(config.height_px) +
                                "; set width_px and height_px to a size of v4l2-ctl --list-formats-ext");
  }
  set_property(capture, path, cv::CAP_PROP_FPS, config.frame_rate_hz,
               fmt::format("frame_rate_hz = {:g}", config.frame_rate_hz), "see v4l2-ctl --list-formats-ext");
  if (config.exposure_s > 0.0) {
    // Video4Linux: menu entry 1 is manual; exposure counts in 100 us.
    capture.set(cv::CAP_PROP_AUTO_EXPOSURE, 1.0);
    set_property(capture, path, cv::CAP_PROP_EXPOSURE, std::max(1.0, std::round(config.exposure_s * 1e4)),
                 fmt::format("exposure_s = {:g}", config.exposure_s),
                 "set it to 0 to leave it to the camera");
  }
  if (config.gain >= 0.0)
    set_property(capture, path, cv::CAP_PROP_GAIN, config.gain, fmt::format("gain = {:g}", config.gain),
                 "set it to -1 to leave it to the camera");
}

VideoCamera::Reader open_device(const CameraSourceConfig& config) {
  const std::string path = device_path(config.source);
  check_device(path);
  auto capture = std::make_shared<cv::VideoCapture>();
  if (!capture->open(path, cv::CAP_V4L2)) {
    throw common::HardwareError(fmt::format(
        "cannot open {}; is another program using it, or is it not the image device of the camera?", path));
  }
  configure(*capture, path, config);
  return [capture](cv::Mat& image) { return capture->read(image); };
}

}  // namespace

struct VideoCamera::Shared {
  Reader reader;
  std::string name;
  double delay_s = 0.0;
  std::mutex mutex;
  std::condition_variable changed;
  imaging::Frame newest;  ///< empty when it was handed out already
  std::string failure;
  bool stop = false;
  std::thread thread;

  /// An exception must not leave a thread: it is kept for grab().
  void read_on() {
    std::string problem;
    try {
      while (true) {
        cv::Mat image;
        if (!reader(image) || image.empty()) break;
        const double stamp_s = common::SteadyClock().now_s() - delay_s;
        const std::lock_guard<std::mutex> lock(mutex);
        if (stop) return;
        newest = {image, stamp_s};
        changed.notify_all();
      }
      problem = "it delivers no more images";
    } catch (const std::exception& error) {
      problem = error.what();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    failure = problem;
    changed.notify_all();
  }
};

VideoCamera::VideoCamera(const CameraSourceConfig& config)
    : VideoCamera(open_device(config), device_path(config.source),
                  config.latency_s + 0.5 * config.exposure_s) {}

VideoCamera::VideoCamera(Reader reader, std::string name, double delay_s)
    : shared_(std::make_unique<Shared>()) {
  shared_->reader = std::move(reader);
  shared_->name = std::move(name);
  shared_->delay_s = delay_s;
  shared_->thread = std::thread([shared = shared_.get()] { shared->read_on(); });
}

VideoCamera::~VideoCamera() {
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->stop = true;
  }
  shared_->thread.join();
}

imaging::Frame VideoCamera::grab(double timeout_s) {
  std::unique_lock<std::mutex> lock(shared_->mutex);
  const auto ready = [this] { return !shared_->newest.image.empty() || !shared_->failure.empty(); };
  shared_->changed.wait_for(lock, std::chrono::duration<double>(timeout_s), ready);
  if (!shared_->newest.image.empty()) return std::exchange(shared_->newest, {});
  if (!shared_->failure.empty()) {
    throw common::HardwareError("camera " + shared_->name + " failed: " + shared_->failure +
                                "; check its cable, then open it anew");
  }
  throw common::HardwareError(
      fmt::format("camera {}: no image within {:g} s; check its cable, its exposure and its frame rate",
                  shared_->name, timeout_s));
}

}  // namespace lodestone::rig
