#pragma once

#include <memory>

#include "lodestone/rig/camera.h"
#include "lodestone/rig/camera_source.h"

namespace lodestone::rig {

/// A GenICam camera (GigE Vision or USB3 Vision, such as the FLIR Blackfly) through Aravis 0.8. The header
/// needs no Aravis; without it (LODESTONE_WITH_ARAVIS off) the constructor says which package is missing.
class AravisCamera final : public Camera {
 public:
  /// Whether this build can open GenICam cameras.
  static bool available();

  /// Opens the camera named `config.source` (as `arv-tool-0.8` lists it, or its address; empty: the first one
  /// found), sets size (the middle of the sensor), rate, exposure, gain and pixel format, and starts it. An
  /// empty pixel format takes the first it offers of Bayer, BGR8, RGB8 and Mono8: Bayer, because full colour
  /// at 1280x1024 and 30 Hz does not fit through gigabit Ethernet. Throws HardwareError, ConfigError.
  explicit AravisCamera(const CameraSourceConfig& config);
  ~AravisCamera() override;

  /// The newest complete image, as BGR, not older than the call before. Stamps are on common::SteadyClock:
  /// arrival of the first packet less latency and half the exposure. Throws HardwareError when none comes in
  /// time or the camera was lost.
  imaging::Frame grab(double timeout_s) override;

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace lodestone::rig
