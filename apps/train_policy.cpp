#include <cstdio>
#include <string>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/log.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/blas.h"
#include "lodestone/rl/policy_environments.h"
#include "lodestone/rl/policy_trainer.h"
#include "lodestone/runs/resumable_run.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using rl::TrainPolicyConfig;

/// What the policy is learned from.
runs::Provenance provenance(const TrainPolicyConfig& config) {
  runs::Provenance made;
  if (config.simulator != rl::Simulator::kMbs) return made;
  const common::Json metrics =
      inference::load_checkpoint(config.dynamics, "dynamics").facts.value("metrics", common::Json());
  if (metrics.empty()) return made;
  const auto dynamics = common::artefact_from_json<runs::DynamicsEvaluation>(metrics, config.dynamics);
  made.dynamics.emplace().one_step.position_rms_mm = dynamics.one_step.position_rms_mm;
  if (dynamics.transitions) made.collect.emplace().transitions = *dynamics.transitions;
  return made;
}

void train_policy(const CommonOptions& options) {
  auto config = resolve_config<TrainPolicyConfig>(options);
  nets::use_one_blas_thread();
  const rl::PolicyEnvironments environments = rl::make_policy_environments(config);
  if (environments.dynamics)
    check_rig(options, config.rig, environments.dynamics->info.rig,
              "dynamics = " + config.dynamics + ": it is");
  runs::RunFolder run(rl::run_request(config, options.out, options.resume));
  const std::string file = run.file(runs::PolicyResult::kFile);
  if (run.finished()) {
    common::log_info("train-policy: " + run.path() + " is finished already");
  } else {
    runs::Provenance made = provenance(config);
    const runs::PolicyResult result = rl::train_policy(config, environments, run);
    made.policy = result;
    inference::set_policy_provenance(run.file("checkpoint"), common::artefact_to_json(made));
    common::write_artefact(file, result);
    runs::show_result(run, common::artefact_to_json(result));
    run.finish();
    common::log_info("wrote " + run.path() + "/checkpoint and result.json");
  }
  std::printf("%s\n", common::read_json_if_there(file).dump().c_str());
}

}  // namespace

void add_train_policy(Verb& program) {
  Verb& verb = program.add_verb("train-policy", "train a policy in the learned simulator");
  CommonOptions& options = configure<TrainPolicyConfig>(verb, train_policy);
  options.rig_is = RigFile::kDescription;
  add_common_options(verb, options, /*with_resume=*/true);
}

}  // namespace lodestone::apps
