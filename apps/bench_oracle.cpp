#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/common/named.h"
#include "lodestone/experiments/deployment_run.h"
#include "lodestone/nets/blas.h"
#include "lodestone/runs/tasks_result.h"
#include "models.h"
#include "trials.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::DeployConfig;

void bench_oracle(const CommonOptions& options) {
  auto config = resolve_config<DeployConfig>(options);
  if (config.deployment.rig.real())
    throw common::InvalidConfig("rig.backend", common::name_of(config.deployment.rig.backend),
                                "be virtual: of a real rig nobody knows what the oracle knows");
  if (config.controller != "auto" && config.controller != "planner")  // which presets and --models name
    throw common::InvalidConfig("controller", config.controller, "be planner or left out: the oracle is one");
  config.deployment = experiments::in_flow(config);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  const experiments::DeploymentJob job = experiments::plan_job(config, {runs::kOracle});
  runs::RunRequest request{options.out, "bench oracle", common::config_to_json(config),
                           config.deployment.seed, options.resume};
  request.free_keys = experiments::free_mcap_keys();
  request.free_keys.insert(request.free_keys.end(), {"threads", "realtime"});
  request.inputs = runs::named_inputs(request.config, {"task", "policy", "dynamics", "sensor.segmenter"});
  runs::RunFolder run(request);
  if (!run.finished()) {
    run.begin();
    experiments::DeploymentRun work(
        config.deployment, job, run.path(),
        experiments::virtual_driver(config.deployment, config.threads, config.realtime,
                                    make_trial_folders(config, run)));
    runs::run_resumably(run, work, {"bench oracle", "trials", 0.0});
    work.write_trials();
    run.finish();
  } else {
    common::log_info("bench oracle: " + run.path() + " is finished already");
  }
  print_deployment(job,
                   common::read_artefact<runs::DeploymentSummary>(run.file(runs::DeploymentSummary::kFile)));
}

}  // namespace

void add_bench_oracle(Verb& bench) {
  Verb& verb = bench.add_verb(
      "oracle", "how well a task could be done: a planner that knows all that is hidden in the virtual rig");
  auto& options = configure<DeployConfig>(verb, bench_oracle);
  add_common_options(verb, options, /*with_resume=*/true);
  add_trials_options(verb, options);
}

}  // namespace lodestone::apps
