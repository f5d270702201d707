#include "lodestone/rig/driver_camera.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/rig/driver_stream.h"

namespace lodestone::rig {

namespace {

constexpr double kOldest_s = 60.0;

int pixels(const DriverReply& reply, const char* key) {
  return static_cast<int>(reply.number(key, 16.0, 16384.0));
}

}  // namespace

cv::Mat driver_image(const DriverReply& reply) {
  const common::Json format = reply.content.value("format", common::Json());
  if (format == "jpeg" || format == "png") {
    cv::Mat image;
    try {
      if (!reply.bytes.empty()) image = cv::imdecode(reply.bytes, cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {  // says no more than that it failed
    }
    if (image.empty())
      throw common::HardwareError("the driver's image is no " + format.get<std::string>() + " of any kind");
    return image;
  }
  const bool grey = format == "gray8";
  if (!grey && format != "bgr8")
    throw common::HardwareError("the driver's image has format = " + common::shown_json(format) +
                                ", it must be bgr8, gray8, jpeg or png");
  const int width = pixels(reply, "width_px"), height = pixels(reply, "height_px");
  const std::size_t size = std::size_t{1} * width * height * (grey ? 1 : 3);
  if (reply.bytes.size() != size)
    throw common::HardwareError(fmt::format("the driver's image of {} x {} px has {} bytes, {} belong there",
                                            width, height, reply.bytes.size(), size));
  const cv::Mat raw(height, width, grey ? CV_8UC1 : CV_8UC3, const_cast<std::uint8_t*>(reply.bytes.data()));
  cv::Mat image;
  if (grey)
    cv::cvtColor(raw, image, cv::COLOR_GRAY2BGR);
  else
    image = raw.clone();
  return image;
}

DriverCamera::DriverCamera(const CameraSourceConfig& config)
    : DriverCamera(
          [&config] {
            return open_driver_stream(config.source, config.start_timeout_s, "rig.camera.source");
          },
          config.start_timeout_s) {}

DriverCamera::DriverCamera(const DriverLink::OpenStream& open, double start_timeout_s)
    : link_(open, "camera", common::Json::object(), start_timeout_s, start_timeout_s) {}

imaging::Frame DriverCamera::grab(double timeout_s) {
  const DriverReply reply = link_.ask({{"do", "image"}}, timeout_s);
  const double now_s = common::SteadyClock().now_s();
  return {driver_image(reply), now_s - reply.number("age_s", 0.0, kOldest_s)};
}

}  // namespace lodestone::rig
