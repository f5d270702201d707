#include "models.h"

#include <filesystem>

#include "lodestone/common/error.h"

namespace lodestone::apps {

std::string own_path() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).string();
}

std::string shipped_folder(const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path program = fs::path(own_path()).parent_path();
  // Working folder; build/<preset>/apps of a source tree; bin of an installed one.
  for (const fs::path& base : {fs::path("."), program / "../../..", program / "../share/lodestone"}) {
    const fs::path folder = base / name;
    if (fs::exists(folder / (name == "models" ? "segmenter/manifest.json" : "paper/deploy.json")))
      return folder.lexically_normal().string();
  }
  throw common::ConfigError("the folder " + name + " of lodestone is not here: run this in the source tree");
}

void choose_segmenter(session::SensingConfig& sensor) {
  if (sensor.kind != "camera" || !sensor.segmenter.empty()) return;
  try {
    sensor.segmenter = shipped_folder("models") + "/segmenter";
  } catch (const common::ConfigError&) {
    throw common::ConfigError(
        "sensor.segmenter is empty and models/segmenter is not here: name a checkpoint with --set "
        "sensor.segmenter=DIR (lodestone train-segmenter makes one), or use --sensor simulated");
  }
}

}  // namespace lodestone::apps
