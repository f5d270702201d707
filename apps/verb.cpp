#include "verb.h"

namespace lodestone::apps {

common::ConfigLayers CommonOptions::layers() const {
  common::ConfigLayers layers;
  if (!rig_file.empty()) layers.add_file(rig_file, "rig");
  for (const std::string& file : config_files) layers.add_file(file);
  for (const Override& value : overrides) layers.set(value.assignment, value.option);
  if (seed) layers.set("seed=" + std::to_string(*seed), "--seed");
  if (threads) layers.set("threads=" + std::to_string(*threads), "--threads");
  return layers;
}

void add_common_options(CLI::App& verb, CommonOptions& options, bool with_resume) {
  verb.add_option("--rig", options.rig_file,
                  "rig.json: what is known of the rig (default: the paper's rig, configs/rigs/paper.json)")
      ->type_name("FILE");
  verb.add_option(
          "--config", options.config_files,
          "JSON configuration; may be given several times, later ones win; presets lie under configs/")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option_function<std::vector<std::string>>(
          "--set",
          [&options](const std::vector<std::string>& assignments) {
            for (const std::string& assignment : assignments)
              options.overrides.push_back(
                  {assignment, "--set " + assignment.substr(0, assignment.find('='))});
          },
          "override one key, for example --set training.epochs=20")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--out", options.out, "folder (or file) to write into")->type_name("PATH");
  verb.add_option("--seed", options.seed, "seed of every random stream of the run");
  verb.add_option("--threads", options.threads,
                  "threads; 0 means one per processor. Results do not depend on it");
  if (with_resume) verb.add_flag("--resume", options.resume, "go on with the interrupted run in --out");
}

void add_shorthand(CLI::App& verb, CommonOptions& options, const std::string& flag, const std::string& key,
                   Shorthand kind, const std::string& meaning) {
  verb.add_option_function<std::string>(
      flag,
      [&options, flag, key, kind](const std::string& value) {
        options.overrides.push_back(
            {key + "=" + (kind == Shorthand::kText ? common::Json(value).dump() : value), flag});
      },
      meaning);
}

void add_virtual_rig_options(CLI::App& verb, CommonOptions& options, const std::string& seed_key) {
  add_shorthand(verb, options, "--deviation", "rig.simulation.deviation", Shorthand::kText,
                "how far the virtual rig is from its description: none, lab or wide");
  if (!seed_key.empty())
    add_shorthand(verb, options, "--rig-seed", seed_key, Shorthand::kValue,
                  "seed of what is hidden in the virtual rig");
}

void add_verbs(CLI::App& program, ConfigCatalogue& catalogue) {
  add_collect(program, catalogue);
  add_import(program, catalogue);
  add_train_segmenter(program, catalogue);
  add_train_dynamics(program, catalogue);
  add_train_policy(program, catalogue);
  add_deploy(program, catalogue);
  add_evaluate(program, catalogue);
  add_calibrate(program, catalogue);
  add_rig(program, catalogue);
  add_bench(program, catalogue);
  add_report(program, catalogue);
  add_status(program, catalogue);
  add_plan(program, catalogue);
  add_config(program, catalogue);
}

}  // namespace lodestone::apps
