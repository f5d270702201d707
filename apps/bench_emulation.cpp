#include <algorithm>
#include <cstdio>
#include <utility>

#include "bounds.h"
#include "common_options.h"
#include "lodestone/experiments/emulation_bench.h"
#include "lodestone/nets/blas.h"
#include "lodestone/runs/run_folder.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::EmulationBench;
using experiments::EmulationBenchConfig;
using experiments::EmulationResult;

void print_round_trips(const EmulationResult& result) {
  std::printf("  round trip p99 %.2f ms; with the whole status median %.2f ms, p99 %.2f ms\n",
              result.round_trip->ping_p99_ms, result.round_trip->status_median_ms,
              result.round_trip->status_p99_ms);
}

void print_real_time(const EmulationResult& result) {
  for (const auto& [how, squares] : {std::pair("in real time", *result.real_time),
                                     std::pair("with every processor busy", *result.under_load)})
    std::printf(
        "  %lld squares %s: %lld pulses, cross-track RMS %.2f mm, deviation of the period median %.2f ms, "
        "p99 %.2f ms "
        "(95 %% interval %.2f to %.2f), largest %.2f ms, real time lost %.2f s\n",
        static_cast<long long>(squares.squares), how, static_cast<long long>(squares.pulses),
        squares.cross_track_rms_mm, squares.deviation_median_ms, squares.deviation_p99_ms,
        squares.deviation_p99_interval_ms[0], squares.deviation_p99_interval_ms[1], squares.deviation_max_ms,
        squares.lost_real_time_s);
}

void print_square(const EmulationResult& result) {
  std::printf(
      "  square, cross-track RMS: %.3f mm with simulated coils, %.3f mm through the firmware (n = %lld)\n",
      result.square->simulated_mm, result.square->emulated_mm, static_cast<long long>(result.square->trials));
  if (result.square->ideal_mm)
    std::printf("  the same with simulated coils whose drivers follow at once: %.3f mm\n",
                *result.square->ideal_mm);
}

void print_faults(const EmulationResult& result) {
  for (const experiments::FaultResult& fault : result.faults) {
    const char* what = fault.held ? "in a pulse of seconds:" : fault.stopped ? "stopped " : "went on ";
    std::printf("  %-34s %s off after %.3f s  %s\n", fault.fault.c_str(), what, fault.on_after_s,
                fault.reason.c_str());
  }
}

void print_long_run(const EmulationResult& result) {
  if (!result.long_run) return;
  std::printf("  %lld pulses in %.0f s of bench time, %zu faults, largest current %.1f A\n",
              static_cast<long long>(result.long_run->pulses), result.long_run->simulated_s,
              result.long_run->faults.size(), result.long_run->largest_current_A);
}

constexpr MeasuredPart<EmulationBench, EmulationResult> kEmulationParts[] = {
    {&EmulationBench::time_round_trips, print_round_trips},
    {&EmulationBench::drive_in_real_time, print_real_time},
    {&EmulationBench::compare_squares, print_square},
    {&EmulationBench::inject_every_fault, print_faults},
    {&EmulationBench::inject_for_long, print_long_run}};

void bench_emulation(const CommonOptions& options) {
  auto config = resolve_config<EmulationBenchConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  runs::RunFolder run(
      {options.out, "bench emulation", common::config_to_json(config), config.deployment.seed});
  EmulationBench bench(config, options.out);
  measure(bench, kEmulationParts, run);
}

}  // namespace

void add_bench_emulation(Verb& bench) {
  Verb& verb = bench.add_verb(
      "emulation",
      "the real firmware on an emulated bench: faults, timing, errors; exit code 1 when a bound is broken");
  auto& options = configure<EmulationBenchConfig>(verb, bench_emulation);
  add_common_options(verb, options);
  add_virtual_rig_options(verb, options);
  add_shorthand(verb, options, "--policy", "policy", Shorthand::kText,
                "folder of the policy checkpoint; without it the planner drives in the simulator of --set "
                "dynamics=DIR, or else the proportional baseline");
  add_mcap_option(verb, options, "a log of each square in the folder's `logs`, which Foxglove opens");
}

}  // namespace lodestone::apps
