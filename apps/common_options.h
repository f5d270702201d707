#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/rig_description.h"
#include "verb.h"

namespace lodestone::apps {

/// One value that an option of the command line gives.
struct Override {
  std::string assignment;  ///< "a.b=value"
  std::string option;      ///< "--set a.b" or a shorthand such as "--sensor"
};

/// What a rig's file is to a verb: a part of its configuration, of which it takes everything or what
/// describes the rig and not how it is reached; or the file of the cells that it runs.
enum class RigFile { kWhole, kDescription, kOfCells };

/// Options every verb takes.
struct CommonOptions {
  std::string rig_file;  ///< --rig
  RigFile rig_is = RigFile::kWhole;
  std::vector<std::string> config_files;  ///< --config, later ones win
  std::vector<Override> overrides;        ///< --set and shorthands, in order
  std::string out;                        ///< --out DIR
  std::optional<std::int64_t> seed;       ///< --seed
  std::optional<std::int64_t> threads;    ///< --threads
  bool resume = false;                    ///< --resume

  /// The rig's file where it belongs to them, then the configurations, then single values.
  common::ConfigLayers layers() const;
};

/// Adds --rig, --config, --set, --out, --seed, --threads to a verb (and --resume where asked). `options` must
/// live as long as the verb, here and below.
void add_common_options(Verb& verb, CommonOptions& options, bool with_resume = false);

/// Refuses what was made of a rig with other figures than the one of --rig, where both are known. `what`:
/// "the recordings are". Throws DataError.
void check_rig(const CommonOptions& options, const physics::RigDescription& rig, const common::Json& made_of,
               const std::string& what);

/// Adds --engine to a verb that runs a plan.
void add_engine_option(Verb& verb, std::string& engine);

/// How the text behind a shorthand option is read.
enum class Shorthand { kText, kValue };

/// An option of the command line that is a short name of a configuration key.
void add_shorthand(Verb& verb, CommonOptions& options, const std::string& flag, const std::string& key,
                   Shorthand kind, const std::string& meaning);
/// --deviation and --rig-seed, for verbs with a virtual rig.
void add_virtual_rig_options(Verb& verb, CommonOptions& options, const std::string& seed_key = "rig_seed");

/// --mcap, for verbs that log what a rig does.
void add_mcap_option(Verb& verb, CommonOptions& options, const std::string& meaning);

/// What the verb's configuration comes to, over the defaults of Config. Throws ConfigError naming the file or
/// option that held a wrong value.
template <class Config>
Config resolve_config(const CommonOptions& options) {
  const common::ConfigLayers layers = options.layers();
  return common::config_from_json<Config>(layers.json(), layers.sources());
}

/// Makes `run` what the verb does, and Config its configuration. Returns the options, which the caller adds
/// to the verb.
template <class Config, class Options>
Options& configure(Verb& verb, void (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  verb.run = [options, run] { run(*options); };
  verb.configuration = [options] {
    const common::ConfigLayers layers = options->layers();
    return common::describe_config<Config>(common::config_from_json<Config>(layers.json(), layers.sources()),
                                           layers.sources());
  };
  return *options;
}

}  // namespace lodestone::apps
