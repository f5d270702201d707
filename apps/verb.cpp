#include "verb.h"

namespace lodestone::apps {

void add_common_options(CLI::App& verb, CommonOptions& options, bool with_resume) {
  verb.add_option("--config", options.config_file, "JSON configuration; presets lie under configs/")
      ->type_name("FILE");
  verb.add_option("--set", options.overrides, "override one key, for example --set training.epochs=20")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb.add_option("--out", options.out, "folder (or file) to write into")->type_name("PATH");
  verb.add_option("--seed", options.seed, "seed of every random stream of the run");
  verb.add_option("--threads", options.threads,
                  "threads; 0 means one per processor. Results do not depend on it");
  if (with_resume) verb.add_flag("--resume", options.resume, "go on with the interrupted run in --out");
}

}  // namespace lodestone::apps
