#include <cstdio>

#include "common_options.h"
#include "lodestone/experiments/rigs_bench.h"
#include "lodestone/nets/blas.h"
#include "lodestone/report/rigs_report.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::RigsBenchConfig;

void print_results(const std::string& folder) {
  const std::string page = folder + "/report.html";
  std::printf("%sreport   %s\n", report::write_rigs_report(folder, page).c_str(), page.c_str());
}

void bench_rigs(const CommonOptions& options) {
  auto config = resolve_config<RigsBenchConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  const experiments::DeployConfig deployment = config.deploy();
  const experiments::DeploymentJob job = experiments::plan_rigs(config, deployment);
  runs::RunRequest request{options.out, "bench rigs", common::config_to_json(config), config.deployment.seed,
                           options.resume};
  request.free_keys = {"threads"};
  request.inputs = runs::named_inputs(request.config, {"policy", "dynamics", "sensor.segmenter"});
  runs::RunFolder run(request);
  if (run.finished()) return print_results(run.path());
  run.begin();
  experiments::RigsRun work(config, deployment, job, run.path(),
                            experiments::virtual_driver(deployment.deployment, deployment.threads, false));
  runs::run_resumably(run, work, {"bench rigs", "trials", 0.0});
  print_results(run.path());
  run.finish();
}

}  // namespace

void add_bench_rigs(Verb& bench) {
  Verb& verb = bench.add_verb(
      "rigs", "controllers on many virtual rigs that nobody has seen, and what their errors depend on");
  auto& options = configure<RigsBenchConfig>(verb, bench_rigs);
  add_common_options(verb, options, /*with_resume=*/true);
  add_virtual_rig_options(verb, options);
  const auto add = [&](const char* flag, const char* key, Shorthand kind, const char* meaning) {
    add_shorthand(verb, options, flag, key, kind, meaning);
  };
  add("--rigs", "rigs", Shorthand::kValue, "how many rigs");
  add("--trials", "trials.count", Shorthand::kValue, "trials of a task on each of them");
  add("--task", "task", Shorthand::kText, "centre, point, square, circle or all");
  add("--sensor", "sensor.kind", Shorthand::kText, "camera or simulated");
  add("--models", "models", Shorthand::kText,
      "folder that holds the policy `any_rig` and the simulator `dynamics_best`");
  add("--controllers", "controllers", Shorthand::kText,
      "with commas between: planner, policy, baseline, observer");
  const auto pulses = [&](const char* flag, const std::string& key, const char* meaning) {
    verb.add_option(
        flag,
        [&options, key, flag](const std::string& value) {
          options.overrides.push_back({key + "=[" + value + "]", flag});
        },
        meaning);
  };
  pulses("--adapt", "adapt",
         "planners beside them that learned each rig from N pulses; with commas between: several");
  pulses("--from-scratch", "from_scratch", "the same, that began with nothing");
  verb.add_option("--decorated", Flag{[&options] {
                    options.overrides.push_back({"decorated=true", "--decorated"});
                  }},
                  "put around every controller what the deploy.json of `target`, or beside the policy that "
                  "is named, says");
}

}  // namespace lodestone::apps
