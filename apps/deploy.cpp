#include <memory>
#include <string>
#include <vector>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/deployment_run.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "terminal.h"
#include "trials.h"
#include "verbs.h"

namespace lodestone::apps {

namespace {

using experiments::DeployConfig;
using experiments::DeploymentJob;

void drive(const DeployConfig& config, const DeploymentJob& job, runs::RunFolder& run) {
  std::unique_ptr<session::RigSession> rig;
  if (config.deployment.rig.real())
    rig =
        session::make_bench_session(config.deployment.rig, config.deployment.sensor, config.deployment.safety,
                                    terminal_operator(config.deployment.rig), run.path());
  run.begin();
  const experiments::TrialFolders folders = make_trial_folders(config, run);
  experiments::DeploymentRun work(
      config.deployment, job, run.path(),
      rig ? experiments::session_driver(*rig, config.deployment, has_operator(), folders)
          : experiments::virtual_driver(config.deployment, config.threads, config.realtime, folders));
  runs::run_resumably(run, work, {"deploy", "trials", 0.0});
  work.write_trials();
  const runs::DeploymentSummary summary = work.summary();
  print_deployment(job, summary);
  if (summary.stopped)
    throw common::HardwareError("deploy: stopped: " + *summary.stopped +
                                "; the trials that have ended are kept, --resume goes on with the others");
  run.finish();
}

void deploy(const CommonOptions& options) {
  auto config = resolve_config<DeployConfig>(options);
  config.deployment = experiments::in_flow(config);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  const DeploymentJob job = experiments::plan_job(config);
  runs::RunRequest request{options.out, "deploy", common::config_to_json(config), config.deployment.seed,
                           options.resume};
  request.free_keys = experiments::free_mcap_keys();
  request.free_keys.insert(request.free_keys.end(), {"threads", "realtime", "rig.serial.port"});
  request.inputs = runs::named_inputs(request.config, {"task", "policy", "dynamics", "sensor.segmenter"});
  runs::RunFolder run(request);
  if (!run.finished()) return drive(config, job, run);
  common::log_info("deploy: " + run.path() + " is finished already");
  print_deployment(job,
                   common::read_artefact<runs::DeploymentSummary>(run.file(runs::DeploymentSummary::kFile)));
}

}  // namespace

void add_deploy(Verb& program) {
  Verb& verb = program.add_verb(
      "deploy", "drive a rig by planning, with a trained policy, or with a baseline (phase 3)");
  auto& options = configure<DeployConfig>(verb, deploy);
  add_common_options(verb, options, /*with_resume=*/true);
  add_virtual_rig_options(verb, options);
  add_trials_options(verb, options);
  add_shorthand(verb, options, "--controller", "controller", Shorthand::kText,
                "planner, policy, baseline, both, or observer");
  const auto set = [&options](const std::string& assignment, const char* flag) {
    options.overrides.push_back({assignment, flag});
  };
  verb.add_option("--record", Flag{[set] { set("record.enabled=true", "--record"); }},
                  "film the first trial of every task, rig and controller");
  add_mcap_option(verb, options, "a log of each trial in the run's `logs`, which Foxglove opens");
  verb.add_option("--realtime", Flag{[set] { set("realtime=true", "--realtime"); }},
                  "wait as long as a real rig would (one trial at a time)");
}

}  // namespace lodestone::apps
