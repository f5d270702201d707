#include "lodestone/rig/aravis_camera.h"

#include <fmt/core.h>

#include <arv.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/realtime.h"

namespace lodestone::rig {
namespace {

constexpr int kBuffers = 8;
constexpr int kLoopbackPacketBytes = 9000;  // smaller ones arrive late and are dropped
constexpr guint kFrameRetention_us = 200000;
constexpr double kForgetsTheDead_s = 4.0;  // GigE Vision's heartbeat is 3 s

/// How a pixel format becomes BGR, in the order of preference. OpenCV names a Bayer pattern by its second
/// row, so the codes are taken by its newer names, which begin with the first.
struct Format {
  const char* name;
  ArvPixelFormat value;
  int channels;
  int to_bgr;  ///< cvtColor code, -1: is BGR already
};
constexpr std::array<Format, 7> kFormats = {{
    {"BayerRG8", ARV_PIXEL_FORMAT_BAYER_RG_8, 1, cv::COLOR_BayerRGGB2BGR},
    {"BayerGB8", ARV_PIXEL_FORMAT_BAYER_GB_8, 1, cv::COLOR_BayerGBRG2BGR},
    {"BayerGR8", ARV_PIXEL_FORMAT_BAYER_GR_8, 1, cv::COLOR_BayerGRBG2BGR},
    {"BayerBG8", ARV_PIXEL_FORMAT_BAYER_BG_8, 1, cv::COLOR_BayerBGGR2BGR},
    {"BGR8", ARV_PIXEL_FORMAT_BGR_8_PACKED, 3, -1},
    {"RGB8", ARV_PIXEL_FORMAT_RGB_8_PACKED, 3, cv::COLOR_RGB2BGR},
    {"Mono8", ARV_PIXEL_FORMAT_MONO_8, 1, cv::COLOR_GRAY2BGR},
}};

/// A GLib error as an exception: pass it to a call, then ask.
class Outcome {
 public:
  ~Outcome() { g_clear_error(&error_); }
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  bool failed() const { return error_ != nullptr; }
  void expect(const std::string& what, const std::string& remedy) const {
    if (failed()) throw common::HardwareError(what + ": " + error_->message + "; " + remedy);
  }

 private:
  GError* error_ = nullptr;
};

/// The image in a buffer. Throws HardwareError for a format that is not known or a buffer that is too
/// short for its size.
cv::Mat to_bgr(ArvBuffer* buffer, const std::string& name) {
  const ArvPixelFormat value = arv_buffer_get_image_pixel_format(buffer);
  const auto format =
      std::find_if(kFormats.begin(), kFormats.end(), [value](const Format& f) { return f.value == value; });
  if (format == kFormats.end())
    throw common::HardwareError(name + ": pixel format " + std::to_string(value) +
                                " is not known, set pixel_format to a Bayer format of 8 bits, RGB8 or Mono8");
  const int width = arv_buffer_get_image_width(buffer);
  const int height = arv_buffer_get_image_height(buffer);
  gint padding_x = 0;
  gint padding_y = 0;
  arv_buffer_get_image_padding(buffer, &padding_x, &padding_y);
  const auto step = static_cast<std::size_t>(width) * format->channels + static_cast<std::size_t>(padding_x);
  std::size_t bytes = 0;
  const void* const data = arv_buffer_get_image_data(buffer, &bytes);
  if (data == nullptr || width <= 0 || height <= 0 || bytes < step * static_cast<std::size_t>(height)) {
    throw common::HardwareError(fmt::format(
        "{}: an image of {}x{} came with {} bytes only; restart the camera", name, width, height, bytes));
  }
  const cv::Mat raw(height, width, CV_8UC(format->channels), const_cast<void*>(data), step);
  cv::Mat image;
  if (format->to_bgr < 0) {
    raw.copyTo(image);
  } else {
    cv::cvtColor(raw, image, format->to_bgr);
  }
  return image;
}

}  // namespace

struct AravisCamera::Device {
  std::string name;
  ArvCamera* camera = nullptr;
  ArvStream* stream = nullptr;
  std::atomic<bool> lost{false};
  bool silent = false;  ///< it did not answer the last time it was asked
  double delay_s = 0.0;

  ~Device() {
    // A register of a dead camera takes seconds to time out.
    if (camera != nullptr && stream != nullptr && !lost && !silent)
      arv_camera_stop_acquisition(camera, Outcome().out());
    g_clear_object(&stream);
    g_clear_object(&camera);
  }

  void open(const CameraSourceConfig& config);
  void take_control() const;
  void set_format(const CameraSourceConfig& config);
  void set_region(const CameraSourceConfig& config);
  void set_exposure(const CameraSourceConfig& config);
  void set_network();
  void start();

  void expect_within(const std::string& key, double value, double min, double max) const {
    if (!(value >= min && value <= max))
      throw common::HardwareError(
          fmt::format("{}: {} = {:g}, must lie in {:g} .. {:g} for this camera", name, key, value, min, max));
  }
  imaging::Frame take(ArvBuffer* buffer) const;
  void drop_stale() const;
};

void AravisCamera::Device::open(const CameraSourceConfig& config) {
  name = config.source.empty() ? "the first GenICam camera" : "GenICam camera " + config.source;
  Outcome outcome;
  camera = arv_camera_new(config.source.empty() ? nullptr : config.source.c_str(), outcome.out());
  const std::string remedy =
      "check power, cable and address, that no other program holds it, and what arv-tool-0.8 lists";
  outcome.expect("cannot open " + name, remedy);
  if (camera == nullptr) throw common::HardwareError("cannot open " + name + ": not found; " + remedy);
  take_control();
  if (config.serial.empty()) return;
  const char* const serial = arv_camera_get_device_serial_number(camera, outcome.out());
  if (serial == nullptr || config.serial != serial)
    throw common::HardwareError(name + " has the serial number " + (serial != nullptr ? serial : "(none)") +
                                ", rig.camera.serial asks for " + config.serial +
                                ": it looks at another bench; correct source or serial");
}

/// A GigE camera obeys the first program that asks; others may only look at its registers. The hold of a
/// program that was killed ends when the camera has not heard of it for a while.
void AravisCamera::Device::take_control() const {
  ArvDevice* const device = arv_camera_get_device(camera);
  if (!ARV_IS_GV_DEVICE(device)) return;
  const common::SteadyClock clock;
  const double until_s = clock.now_s() + kForgetsTheDead_s;
  while (arv_gv_device_take_control(ARV_GV_DEVICE(device), Outcome().out()) == 0) {
    if (clock.now_s() >= until_s)
      throw common::HardwareError("cannot open " + name + ": another program has it open; close that one");
    g_usleep(100000);
  }
  // It may still send its images to the dead.
  arv_camera_stop_acquisition(camera, Outcome().out());
}

void AravisCamera::Device::set_format(const CameraSourceConfig& config) {
  Outcome outcome;
  std::string chosen = config.pixel_format;
  if (chosen.empty()) {
    for (const Format& format : kFormats) {
      if (arv_camera_is_enumeration_entry_available(camera, "PixelFormat", format.name, outcome.out()) != 0) {
        chosen = format.name;
        break;
      }
    }
  }
  const bool known = std::any_of(kFormats.begin(), kFormats.end(),
                                 [&chosen](const Format& format) { return chosen == format.name; });
  if (!known)
    throw common::HardwareError(
        name + ": pixel_format '" + chosen +
        "', must be one of BayerRG8, BayerGB8, BayerGR8, BayerBG8, BGR8, RGB8, Mono8 that the camera offers");
  arv_camera_set_pixel_format_from_string(camera, chosen.c_str(), outcome.out());
  outcome.expect(name + " refuses pixel_format " + chosen, "leave it empty to take what the camera offers");
}

void AravisCamera::Device::set_region(const CameraSourceConfig& config) {
  Outcome outcome;
  gint sensor_width = 0;
  gint sensor_height = 0;
  arv_camera_get_sensor_size(camera, &sensor_width, &sensor_height, outcome.out());
  outcome.expect(name + " does not tell its size", "restart the camera");
  expect_within("width_px", static_cast<double>(config.width_px), 1, sensor_width);
  expect_within("height_px", static_cast<double>(config.height_px), 1, sensor_height);
  const auto width = static_cast<gint>(config.width_px);
  const auto height = static_cast<gint>(config.height_px);
  // The middle of the sensor, on even pixels so that a Bayer pattern keeps its phase.
  const gint x = (sensor_width - width) / 2 / 8 * 8;
  const gint y = (sensor_height - height) / 2 / 8 * 8;
  arv_camera_set_region(camera, x, y, width, height, outcome.out());
  outcome.expect(name + " refuses the size " + std::to_string(width) + "x" + std::to_string(height),
                 "set width_px and height_px to multiples of 16");
}

void AravisCamera::Device::set_exposure(const CameraSourceConfig& config) {
  Outcome outcome;
  double min = 0.0;
  double max = 0.0;
  arv_camera_clear_triggers(camera, outcome.out());
  outcome.expect(name + " keeps its trigger", "reset the camera to its factory settings");
  if (arv_camera_is_frame_rate_available(camera, outcome.out()) != 0) {
    arv_camera_get_frame_rate_bounds(camera, &min, &max, outcome.out());
    if (!outcome.failed()) expect_within("frame_rate_hz", config.frame_rate_hz, min, max);
    arv_camera_set_frame_rate(camera, config.frame_rate_hz, outcome.out());
    outcome.expect(fmt::format("{} refuses frame_rate_hz = {:g}", name, config.frame_rate_hz),
                   "set another one");
  }
  if (config.exposure_s > 0.0) {
    if (arv_camera_is_exposure_auto_available(camera, outcome.out()) != 0)
      arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, outcome.out());
    arv_camera_get_exposure_time_bounds(camera, &min, &max, outcome.out());
    if (!outcome.failed()) expect_within("exposure_s", config.exposure_s, 1e-6 * min, 1e-6 * max);
    arv_camera_set_exposure_time(camera, 1e6 * config.exposure_s, outcome.out());
    outcome.expect(fmt::format("{} refuses exposure_s = {:g}", name, config.exposure_s),
                   "0 leaves it to the camera");
  }
  if (config.gain >= 0.0) {
    if (arv_camera_is_gain_auto_available(camera, outcome.out()) != 0)
      arv_camera_set_gain_auto(camera, ARV_AUTO_OFF, outcome.out());
    arv_camera_get_gain_bounds(camera, &min, &max, outcome.out());
    if (!outcome.failed()) expect_within("gain", config.gain, min, max);
    arv_camera_set_gain(camera, config.gain, outcome.out());
    outcome.expect(fmt::format("{} refuses gain = {:g}", name, config.gain), "-1 leaves it to the camera");
  }
  const double exposure_us = arv_camera_get_exposure_time(camera, outcome.out());
  const double exposure_s = outcome.failed() ? config.exposure_s : 1e-6 * exposure_us;
  delay_s = config.latency_s + 0.5 * exposure_s;
}

void AravisCamera::Device::set_network() {
  if (arv_camera_is_gv_device(camera) == 0) return;
  Outcome outcome;
  // The packet socket needs rights that users lack, and does not see the loopback.
  arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  GSocketAddress* const address =
      arv_gv_device_get_device_address(ARV_GV_DEVICE(arv_camera_get_device(camera)));
  const bool loopback =
      address != nullptr && G_IS_INET_SOCKET_ADDRESS(address) &&
      g_inet_address_get_is_loopback(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))) != 0;
  if (loopback) {
    arv_camera_gv_set_packet_size(camera, kLoopbackPacketBytes, outcome.out());
  } else {
    arv_camera_gv_auto_packet_size(camera, outcome.out());
  }
  outcome.expect(name + " refuses its packet size", "check the network card's MTU");
}

void AravisCamera::Device::start() {
  Outcome outcome;
  const auto on_stream = +[](void*, ArvStreamCallbackType, ArvBuffer*) {
    thread_local const common::RealtimeThread realtime;  // of the thread that puts the packets together
  };
  stream = arv_camera_create_stream(camera, on_stream, nullptr, outcome.out());
  outcome.expect(name + " gives no stream", "restart the camera");
  if (ARV_IS_GV_STREAM(stream))
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_AUTO, "socket-buffer-size", 0,
                 "frame-retention", kFrameRetention_us, nullptr);
  const guint payload = arv_camera_get_payload(camera, outcome.out());
  outcome.expect(name + " does not tell the size of its frames", "restart the camera");
  for (int i = 0; i < kBuffers; ++i) arv_stream_push_buffer(stream, arv_buffer_new_allocate(payload));
  const auto on_lost = +[](ArvDevice*, gpointer flag) { static_cast<std::atomic<bool>*>(flag)->store(true); };
  g_signal_connect(arv_camera_get_device(camera), "control-lost", G_CALLBACK(on_lost), &lost);
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, outcome.out());
  outcome.expect(name + " cannot run continuously", "reset the camera to its factory settings");
  arv_camera_start_acquisition(camera, outcome.out());
  outcome.expect(name + " does not start", "restart the camera");
}

/// When nobody took images for a while, every buffer is full and what they show is old.
void AravisCamera::Device::drop_stale() const {
  gint waiting = 0;
  gint full = 0;
  arv_stream_get_n_buffers(stream, &waiting, &full);
  if (waiting > 0) return;
  for (int i = 0; i < full; ++i) {
    if (ArvBuffer* const buffer = arv_stream_try_pop_buffer(stream)) arv_stream_push_buffer(stream, buffer);
  }
}

imaging::Frame AravisCamera::Device::take(ArvBuffer* buffer) const {
  const double now_s = common::SteadyClock().now_s();
  const double age_s = 1e-6 * static_cast<double>(g_get_real_time()) -
                       1e-9 * static_cast<double>(arv_buffer_get_system_timestamp(buffer));
  return {to_bgr(buffer, name), now_s - age_s - delay_s};
}

bool AravisCamera::available() { return true; }

AravisCamera::AravisCamera(const CameraSourceConfig& config) : device_(std::make_unique<Device>()) {
  device_->open(config);
  device_->set_format(config);
  device_->set_region(config);
  device_->set_exposure(config);
  device_->set_network();
  device_->start();
}

AravisCamera::~AravisCamera() = default;

imaging::Frame AravisCamera::grab(double timeout_s) {
  const common::SteadyClock clock;
  const double deadline_s = clock.now_s() + timeout_s;
  ArvStream* const stream = device_->stream;
  device_->drop_stale();
  int incomplete = 0;
  while (!device_->lost) {
    const double left_s = std::max(0.0, deadline_s - clock.now_s());
    ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream, static_cast<guint64>(1e6 * left_s));
    if (buffer == nullptr) break;
    // Of several that wait, the newest.
    while (ArvBuffer* const newer = arv_stream_try_pop_buffer(stream)) {
      arv_stream_push_buffer(stream, buffer);
      buffer = newer;
    }
    if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) {
      const std::unique_ptr<ArvStream, std::function<void(ArvStream*)>> give_back(
          stream, [buffer](ArvStream* to) { arv_stream_push_buffer(to, buffer); });
      device_->silent = false;
      return device_->take(buffer);
    }
    ++incomplete;
    arv_stream_push_buffer(stream, buffer);
  }
  device_->silent = true;
  if (device_->lost) {
    throw common::HardwareError(device_->name +
                                " was lost: it does not answer; check power and cable, then "
                                "open it anew");
  }
  throw common::HardwareError(fmt::format(
      "{}: no image within {:g} s ({} came with packets missing); check cable, power and the network's load",
      device_->name, timeout_s, incomplete));
}

}  // namespace lodestone::rig
