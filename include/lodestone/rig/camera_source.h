#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/rig/camera.h"

namespace lodestone::rig {

enum class CameraKind { kFiles, kUvc, kGenicam, kDriver };
inline std::vector<std::string> names_of(CameraKind) { return {"files", "uvc", "genicam", "driver"}; }

/// Which camera looks at the dish, and how it is set.
struct CameraSourceConfig {
  CameraKind kind = CameraKind::kFiles;
  std::string source;
  std::string serial;
  std::int64_t width_px = 1280;
  std::int64_t height_px = 1024;
  double frame_rate_hz = 30.0;
  double exposure_s = 0.008;
  double gain = -1.0;
  std::string pixel_format;
  double latency_s = 0.0;
  double start_timeout_s = 5.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("kind", kind, "",
            "images or a video from disk, a USB (UVC) camera, a GenICam camera, or a driver of your own");
    v.field("source", source, "",
            "files: folder, pattern, image or video; uvc: number or /dev path; genicam: name, empty for the "
            "first one found; driver: process:COMMAND or tcp://HOST:PORT");
    v.field("serial", serial, "",
            "genicam: serial number that the camera must have, where several could answer; empty: any");
    v.field("width_px", width_px, "px", "width of the image", {16, 16384});
    v.field("height_px", height_px, "px", "height of the image", {16, 16384});
    v.field("frame_rate_hz", frame_rate_hz, "Hz", "images per second", {0.1, 1000.0});
    v.field("exposure_s", exposure_s, "s", "exposure; 0 leaves it to the camera", {0.0, 1.0});
    v.field("gain", gain, "", "uvc: in the driver's units; genicam: in dB; below 0 leaves it to the camera",
            {-1.0, 1000.0});
    v.field("pixel_format", pixel_format, "",
            "uvc: four letters such as MJPG; genicam: such as BayerRG8; empty chooses");
    v.field("latency_s", latency_s, "s", "from the end of the exposure to the image's arrival", {0.0, 1.0});
    v.field("start_timeout_s", start_timeout_s, "s", "driver: how long it may take to get ready",
            {0.1, 120.0});
  }
};

/// Opens the camera that `config` names. Throws ConfigError when this build has no such kind, IoError when a
/// file is missing, HardwareError when a device is missing, busy, forbidden or refuses its settings.
std::unique_ptr<Camera> open_camera(const CameraSourceConfig& config);

}  // namespace lodestone::rig
