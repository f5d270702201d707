#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"

namespace lodestone::apps {

/// Options every verb takes.
struct CommonOptions {
  std::string config_file;              ///< --config
  std::vector<std::string> overrides;   ///< --set a.b=value, in order
  std::string out;                      ///< --out DIR
  std::optional<std::int64_t> seed;     ///< --seed
  std::optional<std::int64_t> threads;  ///< --threads
  bool resume = false;                  ///< --resume
};

/// Adds --config, --set, --out, --seed, --threads to a verb (and --resume where asked).
void add_common_options(CLI::App& verb, CommonOptions& options, bool with_resume = false);

/// File, then overrides, then --seed and --threads, over the defaults of Config, which has `seed` and
/// `threads`.
template <class Config>
Config resolve_config(const CommonOptions& options) {
  common::Json json =
      options.config_file.empty() ? common::Json::object() : common::read_json_file(options.config_file);
  for (const std::string& assignment : options.overrides) common::apply_override(json, assignment);
  if (options.seed) json["seed"] = *options.seed;
  if (options.threads) json["threads"] = *options.threads;
  Config defaults;
  return common::config_from_json<Config>(
      json, options.config_file.empty() ? "command line" : options.config_file, std::move(defaults));
}

/// What `config --print VERB` shows: every key of a verb's configuration. Verbs enter themselves.
using ConfigCatalogue = std::map<std::string, std::function<std::vector<common::ConfigRow>()>>;

/// Every verb's file defines one of these; it registers the verb, what runs when it is called (throwing
/// common::Error on faults), and its configuration: catalogue["collect"] = [] { return
/// common::describe_config<CollectConfig>(); }.
void add_collect(CLI::App& program, ConfigCatalogue& catalogue);
void add_import(CLI::App& program, ConfigCatalogue& catalogue);
void add_train_segmenter(CLI::App& program, ConfigCatalogue& catalogue);
void add_train_dynamics(CLI::App& program, ConfigCatalogue& catalogue);
void add_train_policy(CLI::App& program, ConfigCatalogue& catalogue);
void add_deploy(CLI::App& program, ConfigCatalogue& catalogue);
void add_evaluate(CLI::App& program, ConfigCatalogue& catalogue);
void add_calibrate(CLI::App& program, ConfigCatalogue& catalogue);
void add_rig(CLI::App& program, ConfigCatalogue& catalogue);
void add_bench(CLI::App& program, ConfigCatalogue& catalogue);
void add_report(CLI::App& program, ConfigCatalogue& catalogue);
void add_status(CLI::App& program, ConfigCatalogue& catalogue);
void add_plan(CLI::App& program, ConfigCatalogue& catalogue);
void add_config(CLI::App& program, ConfigCatalogue& catalogue);

}  // namespace lodestone::apps
