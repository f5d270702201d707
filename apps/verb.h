#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/common/error.h"

namespace lodestone::apps {

/// One value that an option of the command line gives.
struct Override {
  std::string assignment;  ///< "a.b=value"
  std::string option;      ///< "--set a.b" or a shorthand such as "--sensor"
};

/// Options every verb takes.
struct CommonOptions {
  std::string rig_file;                   ///< --rig
  std::vector<std::string> config_files;  ///< --config, later ones win
  std::vector<Override> overrides;        ///< --set and shorthands, in order
  std::string out;                        ///< --out DIR
  std::optional<std::int64_t> seed;       ///< --seed
  std::optional<std::int64_t> threads;    ///< --threads
  bool resume = false;                    ///< --resume

  /// The rig's file, then the configurations, then single values.
  common::ConfigLayers layers() const;
};

/// Adds --rig, --config, --set, --out, --seed, --threads to a verb (and --resume where asked).
void add_common_options(CLI::App& verb, CommonOptions& options, bool with_resume = false);

/// How the text behind a shorthand option is read.
enum class Shorthand { kText, kValue };

/// An option of the command line that is a short name of a configuration key. `options` must live as long as
/// the verb.
void add_shorthand(CLI::App& verb, CommonOptions& options, const std::string& flag, const std::string& key,
                   Shorthand kind, const std::string& meaning);
/// --deviation and --rig-seed, for verbs with a virtual rig.
void add_virtual_rig_options(CLI::App& verb, CommonOptions& options,
                             const std::string& seed_key = "rig_seed");

/// What the verb's configuration comes to, over the defaults of Config. Throws ConfigError naming the file or
/// option that held a wrong value.
template <class Config>
Config resolve_config(const CommonOptions& options) {
  const common::ConfigLayers layers = options.layers();
  return common::config_from_json<Config>(layers.json(), layers.sources());
}

/// Every key of a verb's configuration as the options leave it, and where its value comes from.
template <class Config>
std::vector<common::ConfigRow> describe_resolved(const CommonOptions& options) {
  const common::ConfigLayers layers = options.layers();
  return common::describe_config<Config>(common::config_from_json<Config>(layers.json(), layers.sources()),
                                         layers.sources());
}

/// What `config --print VERB` shows, for the arguments that the verb was given. Verbs enter themselves:
/// catalogue["collect"] = [options] { return describe_resolved<CollectConfig>(*options); }.
using ConfigCatalogue = std::map<std::string, std::function<std::vector<common::ConfigRow>()>>;

/// Registers every verb: what runs when it is called (throwing common::Error on faults), and its
/// configuration.
void add_verbs(CLI::App& program, ConfigCatalogue& catalogue);

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
