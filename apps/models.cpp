#include "models.h"

#include <filesystem>

#include "lodestone/common/artefact.h"
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

namespace {

/// Names a released model, and the simulator that its deploy.json names, by keys that begin with `group`.
/// Returns that deploy.json; null where there is none.
common::Json name_checkpoints(CommonOptions& options, const std::string& folder, const std::string& group) {
  const auto manifest = common::read_json_if_there(folder + "/manifest.json");
  const bool simulator = manifest.is_object() && manifest.value("kind", common::Json()) == "dynamics";
  options.overrides.push_back(
      {group + (simulator ? "dynamics=" : "policy=") + common::Json(folder).dump(), "--models"});
  common::Json preset = common::read_json_if_there(folder + "/deploy.json");
  if (!preset.is_object() || !preset.contains("dynamics") || !preset["dynamics"].is_string()) return preset;
  const std::filesystem::path dynamics(preset["dynamics"].get<std::string>());  // as seen from that folder
  const std::string there = (std::filesystem::path(folder) / dynamics).lexically_normal().string();
  options.overrides.insert(options.overrides.begin(), {group + "dynamics=" + common::Json(there).dump(),
                                                       folder + "/deploy.json: dynamics"});  // others win
  return preset;
}

}  // namespace

void use_models(CommonOptions& options, const std::string& folder) {
  name_checkpoints(options, folder, "");
  options.config_files.insert(options.config_files.begin(), folder + "/deploy.json");
}

void add_models_option(Verb& verb, CommonOptions& options) {
  verb.add_option(
      "--models", [&options](const std::string& folder) { use_models(options, folder); },
      "folder of a released model, with its deploy.json before any --config: a policy, or a simulator to "
      "plan in");
}

void add_points_models_option(Verb& verb, CommonOptions& options) {
  const auto use = [&options](const std::string& folder) {
    const common::Json preset = name_checkpoints(options, folder, "points.");
    if (preset.is_object() && preset.contains("decorators"))
      options.overrides.insert(options.overrides.begin(),
                               {"points.decorators=" + preset["decorators"].dump(),
                                folder + "/deploy.json: decorators"});  // others win
  };
  verb.add_option("--models", use,
                  "folder of a released model that drives to the points at the end, decorated as its "
                  "deploy.json says: a policy, or a simulator to plan in");
}

}  // namespace lodestone::apps
