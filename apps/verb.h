#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"

namespace lodestone::apps {

/// Options every verb takes.
struct CommonOptions {
  std::string config_file;           ///< --config
  std::vector<std::string> overrides;  ///< --set a.b=value, in order
  std::string out;                   ///< --out DIR
  std::optional<std::int64_t> seed;  ///< --seed
  std::optional<std::int64_t> threads;  ///< --threads
  bool resume = false;               ///< --resume
};

/// Adds --config, --set, --out, --seed, --threads to a verb (and --resume where asked).
void add_common_options(CLI::App& verb, CommonOptions& options, bool with_resume = false);

/// File, then overrides, then --seed and --threads, over the defaults of Config, which has `seed` and `threads`.
template <class Config>
Config resolve_config(const CommonOptions& options) {
  common::Json json = options.config_file.empty() ? common::Json::object() : common::read_json_file(options.config_file);
  for (const std::string& assignment : options.overrides) common::apply_override(json, assignment);
  if (options.seed) json["seed"] = *options.seed;
  if (options.threads) json["threads"] = *options.threads;
  return common::config_from_json<Config>(json, options.config_file.empty() ? "command line" : options.config_file);
}

/// Every verb's file defines one of these; it registers the verb and what runs when it is called.
void add_collect(CLI::App& program);
void add_import(CLI::App& program);
void add_train_dynamics(CLI::App& program);
void add_train_policy(CLI::App& program);
void add_deploy(CLI::App& program);
void add_evaluate(CLI::App& program);
void add_rig(CLI::App& program);
void add_bench(CLI::App& program);
void add_report(CLI::App& program);
void add_config(CLI::App& program);

}  // namespace lodestone::apps
