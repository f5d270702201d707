#include "lodestone/rig/camera_source.h"

#include "lodestone/common/error.h"
#include "lodestone/rig/aravis_camera.h"
#include "lodestone/rig/file_camera.h"
#include "lodestone/rig/video_camera.h"

namespace lodestone::rig {

std::unique_ptr<Camera> open_camera(const CameraSourceConfig& config) {
  if (config.kind == "files") return std::make_unique<FileCamera>(config.source, config.frame_rate_hz);
  if (config.kind == "uvc") return std::make_unique<VideoCamera>(config);
  if (config.kind == "genicam") return std::make_unique<AravisCamera>(config);
  throw common::ConfigError("camera.kind = '" + config.kind + "', must be files, uvc or genicam");
}

}  // namespace lodestone::rig
