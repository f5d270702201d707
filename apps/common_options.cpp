#include "common_options.h"

#include "lodestone/common/config.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/engines.h"

namespace lodestone::apps {
namespace {

/// Of a rig's file, the keys that describe the rig. Throws ConfigError where any of its values is wrong.
common::Json description_in(const std::string& rig_file) {
  const common::Json file = common::read_json_file(rig_file);
  common::config_from_json<rig::RigConfig>(file, rig_file);
  const common::Json described = common::config_to_json(physics::RigDescription());
  common::Json kept = common::Json::object();
  for (const auto& [key, value] : file.items())
    if (described.contains(key)) kept[key] = value;
  return kept;
}

}  // namespace

common::ConfigLayers CommonOptions::layers() const {
  common::ConfigLayers layers;
  if (!rig_file.empty() && rig_is == RigFile::kDescription)
    layers.add(description_in(rig_file), rig_file, "rig");
  else if (!rig_file.empty() && rig_is == RigFile::kWhole)
    layers.add_file(rig_file, "rig");
  for (const std::string& file : config_files) layers.add_file(file);
  for (const Override& value : overrides) layers.set(value.assignment, value.option);
  if (seed) layers.set("seed=" + std::to_string(*seed), "--seed");
  if (threads) layers.set("threads=" + std::to_string(*threads), "--threads");
  return layers;
}

void add_common_options(Verb& verb, CommonOptions& options, bool with_resume) {
  verb.add_option("--rig", &options.rig_file,
                  "rig.json: what is known of the rig (default: the paper's rig, configs/rigs/paper.json)")
      .named("FILE");
  verb.add_option(
          "--config", &options.config_files,
          "JSON configuration; may be given several times, later ones win; presets lie under configs/")
      .named("FILE")
      .repeated();
  const auto set = [&options](const std::string& assignment) {
    options.overrides.push_back({assignment, "--set " + assignment.substr(0, assignment.find('='))});
  };
  verb.add_option("--set", set, "override one key, for example --set training.epochs=20")
      .named("KEY=VALUE")
      .repeated();
  verb.add_option("--out", &options.out, "folder (or file) to write into").named("PATH");
  verb.add_option("--seed", &options.seed, "seed of every random stream of the run");
  verb.add_option("--threads", &options.threads,
                  "threads; 0 means one per processor. Results do not depend on it");
  if (with_resume) verb.add_option("--resume", &options.resume, "go on with the interrupted run in --out");
}

void check_rig(const CommonOptions& options, const physics::RigDescription& rig, const common::Json& made_of,
               const std::string& what) {
  if (options.rig_file.empty() || !made_of.is_object() || !made_of.contains("coils")) return;
  if (physics::completed_rig(made_of) != common::config_to_json(rig))
    throw common::DataError(what + " of a rig with other figures than " + options.rig_file +
                            ": leave --rig out, or record that rig");
}

void add_engine_option(Verb& verb, std::string& engine) {
  verb.add_option("--engine", &engine, "ninja: on this machine; slurm: on a cluster (docs/scale.md)")
      .named("NAME")
      .one_of(runs::engine_names())
      .with_default();
}

void add_shorthand(Verb& verb, CommonOptions& options, const std::string& flag, const std::string& key,
                   Shorthand kind, const std::string& meaning) {
  const auto override_key = [&options, flag, key, kind](const std::string& value) {
    options.overrides.push_back(
        {key + "=" + (kind == Shorthand::kText ? common::Json(value).dump() : value), flag});
  };
  verb.add_option(flag, override_key, meaning);
}

void add_virtual_rig_options(Verb& verb, CommonOptions& options, const std::string& seed_key) {
  add_shorthand(verb, options, "--deviation", "rig.simulation.deviation", Shorthand::kText,
                "how far the virtual rig is from its description: none, lab or wide");
  add_shorthand(verb, options, "--rig-seed", seed_key, Shorthand::kValue,
                "seed of what is hidden in the virtual rig");
}

void add_mcap_option(Verb& verb, CommonOptions& options, const std::string& meaning) {
  verb.add_option("--mcap", Flag{[&options] {
                    options.overrides.push_back({"mcap.enabled=true", "--mcap"});
                  }},
                  meaning);
}

}  // namespace lodestone::apps
