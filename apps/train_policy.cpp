#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rl/policy_environments.h"
#include "lodestone/rl/policy_trainer.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

using rl::TrainPolicyConfig;

/// What made the policy, under the keys of summary.json.
common::Json provenance(const TrainPolicyConfig& config, const rl::PolicyRunResult& result) {
  common::Json facts = {{"policy",
                         {{"env_steps", result.env_steps},
                          {"updates", result.updates},
                          {"train_seconds", result.train_seconds}}}};
  if (config.simulator != "mbs") return facts;
  const common::Json metrics =
      inference::load_checkpoint(config.dynamics, "dynamics").facts.value("metrics", common::Json::object());
  if (metrics.contains("transitions")) facts["collect"]["transitions"] = metrics["transitions"];
  if (metrics.contains("position_rms_mm")) facts["dynamics"]["position_rms_mm"] = metrics["position_rms_mm"];
  return facts;
}

void train_policy(const CommonOptions& options) {
  auto config = resolve_config<TrainPolicyConfig>(options);
  if (options.out.empty()) throw common::ConfigError("train-policy needs --out, the folder of the run");
  const std::string result_file = options.out + "/result.json";
  if (options.resume && std::filesystem::exists(result_file)) {
    common::log_info("train-policy: " + options.out + " is finished already");
    std::printf("%s\n", common::read_json_file(result_file).dump().c_str());
    return;
  }
  nets::use_one_blas_thread();
  const rl::PolicyEnvironments environments = rl::make_policy_environments(config);
  const common::Json json = common::config_to_json(config);
  common::start_run_folder(options.out, "train-policy", json, config.seed, options.resume);
  const rl::PolicyRunResult result =
      rl::train_policy(config, *environments.training, *environments.evaluation, options.out, options.resume,
                       environments.region.get());
  inference::set_policy_provenance(options.out + "/checkpoint", provenance(config, result));
  common::write_file_atomically(result_file, result.json().dump(2) + "\n");
  common::log_info("wrote " + options.out + "/checkpoint and result.json");
  std::printf("%s\n", result.json().dump().c_str());
}

}  // namespace

void add_train_policy(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb = program.add_subcommand("train-policy", "train a TD3 policy in the learned simulator");
  auto options = std::make_shared<CommonOptions>();
  catalogue["train-policy"] = [options] { return describe_resolved<TrainPolicyConfig>(*options); };
  add_common_options(*verb, *options, /*with_resume=*/true);
  verb->callback([options] { train_policy(*options); });
}

}  // namespace lodestone::apps
