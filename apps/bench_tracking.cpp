#include <cstdio>

#include "bounds.h"
#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/experiments/tracking_bench.h"
#include "lodestone/nets/blas.h"
#include "lodestone/runs/run_folder.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::TrackingBench;
using experiments::TrackingBenchConfig;
using experiments::TrackingResult;

void print_masked(const char* whose, const experiments::MaskedTape& tape) {
  std::printf(
      "tape masked, steps of %s: %lld, %lld wrong (95 %% interval of the share %.3f to %.3f %%), %lld "
      "undecided; the end "
      "nearest to the old heading would be wrong in %lld\n",
      whose, static_cast<long long>(tape.steps), static_cast<long long>(tape.wrong),
      100.0 * tape.wrong_interval[0], 100.0 * tape.wrong_interval[1], static_cast<long long>(tape.undecided),
      static_cast<long long>(tape.wrong_by_nearest));
}

void print_trials(const std::string& how, const experiments::TrackedTrials& trials) {
  std::printf(
      "%s: %lld trials, %lld of %lld observations without a pose (of %lld the axis was seen, on %lld of "
      "these it was driven), %lld flipped, largest error %.2f mm, %lld "
      "trials lost (95 %% interval of the share %.1f to %.1f %%); the region of 95 %% held %.1f %%, "
      "normalised "
      "innovation %.2f\n",
      how.c_str(), static_cast<long long>(trials.trials), static_cast<long long>(trials.unseen),
      static_cast<long long>(trials.observations), static_cast<long long>(trials.undecided),
      static_cast<long long>(trials.driven_undecided), static_cast<long long>(trials.flipped),
      trials.worst_mm, static_cast<long long>(trials.lost), 100.0 * trials.lost_interval[0],
      100.0 * trials.lost_interval[1], 100.0 * trials.covered_share, trials.innovation);
}

void print(const TrackingResult& result, const std::string& sensor) {
  print_masked("the explorer", *result.masked_tape);
  print_masked("the trials", *result.masked_while_driven);
  print_trials((sensor == "camera" ? "by camera" : "by the simulated sensor"), *result.trials);
  for (const experiments::SpoiledTrials& spoiled : result.spoiled) {
    print_trials(spoiled.how, spoiled.tracked);
    std::printf("  of these squares %.0f %% succeeded (95 %% interval %.1f to %.1f %%)\n",
                100.0 * spoiled.success_share, 100.0 * spoiled.success_interval[0],
                100.0 * spoiled.success_interval[1]);
  }
  print_bounds(result.figures);
}

void bench_tracking(const CommonOptions& options) {
  auto config = resolve_config<TrackingBenchConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  runs::RunFolder run(
      {options.out, "bench tracking", common::config_to_json(config), config.deployment.seed});
  TrackingBench bench(config);
  run.begin();
  bench.mask_tape();
  bench.drive();
  bench.spoil();
  bench.check();
  print(bench.result(), config.deployment.sensor.kind);
  common::write_artefact(run.file(TrackingResult::kFile), bench.result());
  run.finish();
  check_bounds("bench tracking", bench.result().figures);
}

}  // namespace

void add_bench_tracking(Verb& bench) {
  Verb& verb = bench.add_verb(
      "tracking",
      "how well the needle is kept in sight: its head without a tape, trials on unseen rigs, sensors "
      "that fail; exit code 1 when a bound is broken");
  auto& options = configure<TrackingBenchConfig>(verb, bench_tracking);
  add_common_options(verb, options);
  add_virtual_rig_options(verb, options);
  add_shorthand(verb, options, "--trials", "trials.count", Shorthand::kValue, "squares, and as many circles");
}

}  // namespace lodestone::apps
