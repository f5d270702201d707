#include <algorithm>
#include <cstdio>
#include <functional>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
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

void print(const TrackingResult& result) {
  print_masked("the explorer", *result.masked_tape);
  print_masked("the trials", *result.masked_while_driven);
  const experiments::CameraTrials& camera = *result.camera;
  std::printf(
      "by camera: %lld squares and circles, %lld of %lld observations without a pose, %lld flipped, %lld "
      "trials lost (95 "
      "%% interval of the share %.1f to %.1f %%)\n",
      static_cast<long long>(camera.trials), static_cast<long long>(camera.unseen),
      static_cast<long long>(camera.observations), static_cast<long long>(camera.flipped),
      static_cast<long long>(camera.lost), 100.0 * camera.lost_interval[0], 100.0 * camera.lost_interval[1]);
  for (const experiments::BoundedFigure& one : result.figures)
    std::printf("%-52s %9.3f %-3s bound %.3f  %s\n", one.figure.c_str(), one.value, one.unit.c_str(),
                one.bound, one.ok ? "ok" : "BROKEN");
}

void bench_tracking(const CommonOptions& options) {
  auto config = resolve_config<TrackingBenchConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  runs::RunFolder run(
      {options.out, "bench tracking", common::config_to_json(config), config.deployment.seed});
  run.begin();
  TrackingBench bench(config);
  bench.mask_tape();
  bench.drive_by_camera();
  print(bench.result());
  common::write_artefact(run.file(TrackingResult::kFile), bench.result());
  run.finish();
  const auto broken = std::count_if(bench.result().figures.begin(), bench.result().figures.end(),
                                    [](const experiments::BoundedFigure& one) { return !one.ok; });
  if (broken > 0)
    throw common::HardwareError("bench tracking: " + std::to_string(broken) +
                                " bounds are broken, see above");
}

}  // namespace

void add_bench_tracking(Verb& bench) {
  Verb& verb = bench.add_verb(
      "tracking",
      "how well the needle is kept in sight: its head without a tape, trials by camera; exit code "
      "1 when a bound is broken");
  auto& options = configure<TrackingBenchConfig>(verb, bench_tracking);
  add_common_options(verb, options);
  add_virtual_rig_options(verb, options);
  add_shorthand(verb, options, "--trials", "trials.count", Shorthand::kValue, "squares, and as many circles");
}

}  // namespace lodestone::apps
