// Built instead of aravis_camera.cpp where Aravis is not installed.
#include "lodestone/common/error.h"
#include "lodestone/rig/aravis_camera.h"

namespace lodestone::rig {

struct AravisCamera::Device {};

bool AravisCamera::available() { return false; }

AravisCamera::AravisCamera(const CameraSourceConfig& /*config*/) {
  throw common::ConfigError(
      "camera.kind = genicam, but this build has no Aravis; install libaravis-dev and libusb-1.0-0-dev, then "
      "configure with -DLODESTONE_WITH_ARAVIS=ON and build again");
}

AravisCamera::~AravisCamera() = default;

imaging::Frame AravisCamera::grab(double /*timeout_s*/) {
  throw common::LogicFault("a camera without Aravis cannot exist");
}

}  // namespace lodestone::rig
