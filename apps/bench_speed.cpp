#include <cstdio>
#include <string>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/speed.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::Rate;
using experiments::SpeedConfig;
using experiments::SpeedResult;

void print_row(const std::string& name, double middle, double least, double most, const char* unit,
               const std::string& note) {
  std::printf("%-36s %10.1f  (%.1f .. %.1f) %-18s %s\n", name.c_str(), middle, least, most, unit,
              note.c_str());
}

/// `scale`: what one unit of the table is.
void print_rate(const std::string& name, const char* unit, double scale, const Rate& rate) {
  char fraction[32] = "";
  if (rate.fraction_of_peak)
    std::snprintf(fraction, sizeof fraction, "%5.1f %% of sgemm", 100.0 * *rate.fraction_of_peak);
  print_row(name, rate.median / scale, rate.least / scale, rate.most / scale, unit, fraction);
}

void print_threaded(const std::string& name, const char* unit, double scale,
                    const experiments::ThreadedRate& rate) {
  print_rate(name + ", 1 thread", unit, scale, rate.one_thread);
  print_rate(name + ", all threads", unit, scale, rate.all_threads);
}

void print_latency(const char* name, const experiments::Latency& latency) {
  char note[48];
  std::snprintf(note, sizeof note, "p99 %.2f ms", latency.p99_ms);
  std::printf("%-36s %10.2f  (%.2f .. %.2f) %-18s %s\n", name, latency.median_ms, latency.least_ms,
              latency.most_ms, "ms", note);
}

void print_result(const SpeedResult& result, const SpeedConfig& config) {
  std::printf(
      "%s, %lld threads, BLAS core %s, own kernels %s, commit %s, %lld rounds of %g s: median (least .. "
      "most)\n",
      result.machine["processor"].get<std::string>().c_str(), static_cast<long long>(result.threads),
      result.blas_core.c_str(), result.kernels.c_str(),
      result.machine["git_commit"].get<std::string>().c_str(), static_cast<long long>(config.runs),
      config.run_s);
  print_threaded("sgemm 256^3", "GFLOP/s", 1e9, result.sgemm);
  print_threaded("own product, bias, ReLU", "GFLOP/s", 1e9, result.gemm);
  print_threaded("TD3", "updates/s", 1.0, result.td3);
  print_rate("TD3, plain autograd, 1 thread", "updates/s", 1.0, *result.td3.autograd_one_thread);
  print_threaded("MBS", "thousand steps/s", 1e3, result.mbs);
  print_threaded("virtual rig", "control steps/s", 1.0, result.rig);
  for (const auto& [environments, rate] : *result.mbs.scales)
    print_rate("MBS of " + std::to_string(environments) + ", all threads", "thousand steps/s", 1e3, rate);
  const std::string slow =
      common::slow_blas_note(result.blas_core, result.sgemm.one_thread.median, result.gemm.one_thread.median);
  if (!slow.empty()) common::log_warning(slow);
  print_latency("image to pose, 1 thread", result.pose);
  print_latency("image to currents, 1 thread", result.control);
  if (result.planner_decision) print_latency("identified and planned, 1 thread", *result.planner_decision);
  if (result.policy_decision) print_latency("identified, by a policy, 1 thread", *result.policy_decision);
  std::printf("%-36s %10.1f  MB, most held while training with a full buffer of a million transitions\n",
              "memory", result.training_peak_mb);
}

void bench_speed(const CommonOptions& options) {
  auto config = resolve_config<SpeedConfig>(options);
  if (!options.out.empty())
    common::make_folders(options.out);  // a folder that cannot be made is found out now
  nets::use_one_blas_thread();
  if (config.segmenter.empty()) {
    session::SensingConfig shipped;
    choose_segmenter(shipped);
    config.segmenter = shipped.segmenter;
  }
  std::string command = "lodestone bench speed";
  for (const Override& value : options.overrides) command += " --set " + value.assignment;
  if (options.threads) command += " --threads " + std::to_string(*options.threads);
  const SpeedResult result = experiments::measure_speed(config, command);
  print_result(result, config);
  if (!options.out.empty()) common::write_artefact(options.out + "/" + SpeedResult::kFile, result);
}

}  // namespace

void add_bench_speed(Verb& bench) {
  Verb& verb = bench.add_verb("speed",
                              "rates of the matrix product, TD3, the MBS and the virtual rig, "
                              "time from an image to a pose and to currents, "
                              "memory of training; --out DIR also writes speed.json");
  add_common_options(verb, configure<SpeedConfig>(verb, bench_speed));
}

void add_bench(Verb& program) {
  Verb& verb = program.add_verb("bench", "measure this machine");
  verb.renamed = {{"hil", "emulation"}};
  add_bench_rigs(verb);
  add_bench_speed(verb);
  add_bench_tasks(verb);
  add_bench_oracle(verb);
  add_bench_tracking(verb);
  add_bench_console(verb);
  add_bench_emulation(verb);
  add_bench_paper(verb);
}

}  // namespace lodestone::apps
