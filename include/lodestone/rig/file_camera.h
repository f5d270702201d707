#pragma once

#include <memory>
#include <string>

#include "lodestone/rig/camera.h"

namespace lodestone::rig {

/// Images from disk as a camera: a folder of images or a pattern such as `run/frame_*.png` (in the order
/// of their names, so number them with leading zeros), one image, or a video file. Images are handed out
/// as they are stored, so that an imaging::FrameGuard sees what is wrong with them; an alpha channel is
/// dropped.
class FileCamera final : public Camera {
 public:
  /// Stamps are 0, 1/frame_rate_hz, 2/frame_rate_hz... Throws IoError when there is nothing to read at
  /// `source`, ConfigError when the rate is not positive.
  FileCamera(const std::string& source, double frame_rate_hz);
  ~FileCamera() override;

  /// Throws HardwareError naming the file when it cannot be decoded, and at the end. Never waits.
  imaging::Frame grab(double timeout_s) override;

 private:
  struct Source;
  std::unique_ptr<Source> source_;
};

}  // namespace lodestone::rig
