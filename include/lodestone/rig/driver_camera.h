#pragma once

#include "lodestone/rig/camera.h"
#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/driver_link.h"

namespace lodestone::rig {

/// A camera behind a driver outside the program (docs/driver-protocol.md). It says of each image how old it
/// is, so that no two clocks have to agree.
class DriverCamera final : public Camera {
 public:
  /// Throws ConfigError for an address (`source`) that is none, HardwareError where the driver cannot be
  /// reached.
  explicit DriverCamera(const CameraSourceConfig& config);
  DriverCamera(const DriverLink::OpenStream& open, double start_timeout_s);

  imaging::Frame grab(double timeout_s) override;

 private:
  DriverLink link_;
};

/// The image of a driver's answer. Throws HardwareError where it is none.
cv::Mat driver_image(const DriverReply& reply);

}  // namespace lodestone::rig
