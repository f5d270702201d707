#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/adaptation_run.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "terminal.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct AdaptOptions : CommonOptions {
  bool rollback = false;
};

void print_result(const runs::RunFolder& run, const runs::Adaptation& result) {
  std::printf("%lld pulses, %.1f minutes of the rig, %lld placements by the operator\n",
              static_cast<long long>(result.pulses), result.rig_minutes,
              static_cast<long long>(result.placements));
  if (result.log_drive_gain)
    std::printf(
        "the rig answers %.2f times as strongly as the simulator thought (one standard deviation: %.1f %%)\n",
        std::exp(*result.log_drive_gain), 100.0 * result.log_drive_gain_sigma.value_or(0.0));
  std::printf("%lld pulses held back, mean log-likelihood: ", static_cast<long long>(result.held_back));
  if (result.log_likelihood_before && result.log_likelihood_with_gain)
    std::printf("as it was %.3f, with that gain %.3f, ", *result.log_likelihood_before,
                *result.log_likelihood_with_gain);
  std::printf("learned %.3f\n", result.log_likelihood);
  if (result.better_by)
    std::printf("learned less with gain: %.3f (95 %%: %.3f to %.3f): %s\n", *result.better_by,
                result.better_by_low.value_or(0.0), result.better_by_high.value_or(0.0),
                result.kept ? "kept"
                : result.better_by_high.value_or(0.0) < 0.0
                    ? "worse, and not kept: the simulator is as it was"
                    : "not kept, as that may be chance: the simulator is as it was");
  if (result.rolled_back) std::printf("taken back: the simulator is as it was\n");
  std::printf("next: lodestone deploy --models %s --task point --out DIR\n", run.file("model").c_str());
}

void adapt(const AdaptOptions& options) {
  if (options.rollback) {
    if (options.out.empty())
      throw common::ConfigError("adapt --rollback: --out DIR is missing; name the run");
    experiments::roll_back(options.out);
    return common::log_info("adapt: " + options.out + "/model is again what it was");
  }
  const auto given = [&options](const char* option) {
    return std::any_of(options.overrides.begin(), options.overrides.end(),
                       [option](const Override& value) { return value.option == option; });
  };
  if (given("--pulses") && given("--minutes"))
    throw common::ConfigError("adapt: --pulses and --minutes both say how long; name one");
  auto config = resolve_config<experiments::AdaptationConfig>(options);
  if (config.from_scratch == !config.dynamics.empty())
    throw common::ConfigError(
        "adapt: name the simulator to begin with (--models models/dynamics_best), or --from-scratch, not "
        "both");
  nets::use_one_blas_thread();
  choose_segmenter(config.collection.sensor);
  runs::RunRequest request{options.out, "adapt", common::config_to_json(config), config.collection.seed,
                           options.resume};
  request.free_keys = {"threads", "checkpoint_every_s", "rig.serial.port"};
  request.inputs = runs::named_inputs(request.config, {"dynamics", "sensor.segmenter"});
  runs::RunFolder run(request);
  const std::string file = run.file(runs::Adaptation::kFile);
  if (run.finished()) {
    common::log_info("adapt: " + run.path() + " is finished already");
    return print_result(run, common::read_artefact<runs::Adaptation>(file));
  }
  const experiments::CollectionConfig& collection = config.collection;
  experiments::AdaptationRun work(config, run, [&] {
    if (!collection.rig.real()) return experiments::make_exploration_session(collection);
    return session::make_bench_session(collection.rig, collection.sensor, collection.safety,
                                       terminal_operator(collection.rig), run.path());
  });
  const runs::Adaptation result = work.run();
  run.finish();
  print_result(run, result);
}

}  // namespace

void add_adapt(Verb& program) {
  Verb& verb = program.add_verb(
      "adapt", "learn a rig from its own pulses, from a released simulator on or from nothing");
  auto& options = configure<experiments::AdaptationConfig>(verb, adapt);
  add_common_options(verb, options, /*with_resume=*/true);
  add_virtual_rig_options(verb, options);
  const auto set = [&options](const std::string& assignment, const char* flag) {
    options.overrides.push_back({assignment, flag});
  };
  verb.add_option(
      "--models",
      [set](const std::string& folder) { set("dynamics=" + common::Json(folder).dump(), "--models"); },
      "folder of the simulator to begin with");
  add_shorthand(verb, options, "--pulses", "transitions", Shorthand::kValue, "pulses to learn from");
  add_shorthand(verb, options, "--minutes", "minutes", Shorthand::kValue, "or so many minutes of them");
  add_shorthand(verb, options, "--sensor", "sensor.kind", Shorthand::kText, "camera or simulated");
  verb.add_option("--from-scratch", Flag{[set] { set("from_scratch=true", "--from-scratch"); }},
                  "begin with nothing: explore first");
  verb.add_option("--rollback", Flag{[&options] { options.rollback = true; }},
                  "take the adaptation in --out back: the simulator is again what it was before");
}

}  // namespace lodestone::apps
