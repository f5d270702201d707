#include "lodestone/rig/camera_source.h"

#include "lodestone/common/error.h"
#include "lodestone/rig/aravis_camera.h"
#include "lodestone/rig/driver_camera.h"
#include "lodestone/rig/file_camera.h"
#include "lodestone/rig/video_camera.h"

namespace lodestone::rig {

std::unique_ptr<Camera> open_camera(const CameraSourceConfig& config) {
  if (config.kind == CameraKind::kUvc) return std::make_unique<VideoCamera>(config);
  if (config.kind == CameraKind::kGenicam) return std::make_unique<AravisCamera>(config);
  if (config.kind == CameraKind::kDriver) return std::make_unique<DriverCamera>(config);
  if (config.source.empty())
    throw common::IoError(
        "rig.camera.source is empty: name the camera, with rig.camera.kind \"uvc\" or \"genicam\", or a "
        "folder of "
        "images");
  return std::make_unique<FileCamera>(config.source, config.frame_rate_hz);
}

}  // namespace lodestone::rig
