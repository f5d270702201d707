#include "models.h"

#include <filesystem>

#include "lodestone/common/error.h"

namespace lodestone::apps {

void choose_segmenter(control::SensingConfig& sensor) {
  if (sensor.kind != "camera" || !sensor.segmenter.empty()) return;
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  // Working folder; build/<preset>/apps of a source tree; bin of an installed one.
  for (const fs::path& base :
       {fs::path("models"), program / "../../../models", program / "../share/lodestone/models"}) {
    if (!fs::exists(base / "segmenter" / "manifest.json")) continue;
    sensor.segmenter = (base / "segmenter").lexically_normal().string();
    return;
  }
  throw common::ConfigError(
      "sensor.segmenter is empty and models/segmenter is not here: name a checkpoint with --set "
      "sensor.segmenter=DIR (lodestone train-segmenter makes one), or use --sensor simulated");
}

}  // namespace lodestone::apps
