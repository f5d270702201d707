#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "lodestone/rig/camera.h"
#include "lodestone/rig/camera_source.h"

namespace lodestone::rig {

/// A USB (UVC) camera through Video4Linux. A thread reads it all the time and keeps the newest image only,
/// so grab() hands out what is seen now and never waits longer than it was allowed to.
class VideoCamera final : public Camera {
 public:
  /// Waits for the next image and puts it into its argument, which comes in empty; false when there will be
  /// no more.
  using Reader = std::function<bool(cv::Mat&)>;

  /// Opens device `config.source` (a number or a /dev path) with the size, rate, exposure and gain of
  /// `config`. Throws HardwareError when it is missing, forbidden, busy or refuses them.
  explicit VideoCamera(const CameraSourceConfig& config);

  /// Reads from anything else. `delay_s`: from the middle of the exposure to the reader's return.
  VideoCamera(Reader reader, std::string name, double delay_s);

  /// Waits for the reader to return; Video4Linux gives up on a dead camera after 10 s.
  ~VideoCamera() override;

  /// An image that was not handed out before. Stamps are on common::SteadyClock. Throws HardwareError when
  /// none comes in time, or when the camera has failed.
  imaging::Frame grab(double timeout_s) override;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace lodestone::rig
