#include "lodestone/experiments/speed.h"

#include <array>
#include <utility>

#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/inference/gemm.h"
#include "speed_figures.h"

namespace lodestone::experiments {
namespace {

using common::percentile;

constexpr std::array<int, 4> kScales = {1024, 4096, 16384, 65536};  // environments of an MBS

/// A rate, the place of its result, and what it is compared with.
struct Row {
  Rate* place;
  RateFigure figure;
  double flop = 0.0;     ///< of one unit of work
  std::size_t peak = 0;  ///< row of the rate it is compared with
  std::vector<double> rounds = {};
};

constexpr std::size_t kSgemmOne = 0;
constexpr std::size_t kSgemmAll = 1;

std::vector<Row> rows_of(const SpeedConfig& config, std::int64_t threads, SpeedResult& result) {
  rl::Td3Config td3;
  td3.batch_size = config.td3_batch;
  rl::Td3Config reference = td3;
  reference.backend = rl::Td3Backend::kAutograd;
  const double update_flop = td3_update_flop(td3);
  const double step_flop = mbs_step_flop();
  result.gemm.flop = 1.0;
  result.td3.flop = update_flop;
  result.mbs.flop = step_flop;
  std::vector<Row> rows = {
      {&result.sgemm.one_thread, sgemm_rate(config, 1)},
      {&result.sgemm.all_threads, sgemm_rate(config, threads)},
      {&result.gemm.one_thread, gemm_rate(config, 1), 1.0, kSgemmOne},
      {&result.gemm.all_threads, gemm_rate(config, threads), 1.0, kSgemmAll},
      {&result.td3.one_thread, td3_rate(config, td3, 1), update_flop, kSgemmOne},
      {&result.td3.all_threads, td3_rate(config, td3, threads), update_flop, kSgemmAll},
      {&result.td3.autograd_one_thread.emplace(), td3_rate(config, reference, 1), update_flop, kSgemmOne},
      {&result.mbs.one_thread, mbs_rate(config, config.mbs_environments, 1), step_flop, kSgemmOne},
      {&result.mbs.all_threads, mbs_rate(config, config.mbs_environments, threads), step_flop, kSgemmAll},
      {&result.rig.one_thread, rig_rate(config, 1)},
      {&result.rig.all_threads, rig_rate(config, threads)},
  };
  std::map<int, Rate>& scales = result.mbs.scales.emplace();
  for (const int environments : kScales)
    rows.push_back({&scales[environments], mbs_rate(config, environments, threads), step_flop, kSgemmAll});
  return rows;
}

Latency latency_of(const std::vector<double>& ms, std::int64_t missed) {
  return {common::median(ms),
          percentile(ms, 0.99),
          percentile(ms, 0.0),
          percentile(ms, 1.0),
          static_cast<std::int64_t>(ms.size()),
          missed};
}

}  // namespace

Rate rate_of(const std::vector<double>& rounds, double flop, const std::vector<double>& peak_rounds) {
  Rate rate{common::median(rounds), percentile(rounds, 0.0), percentile(rounds, 1.0), {}, {}};
  if (flop == 0.0) return rate;
  std::vector<double> fractions;
  for (std::size_t i = 0; i < rounds.size(); ++i) fractions.push_back(rounds[i] * flop / peak_rounds[i]);
  rate.fraction_of_peak = common::median(fractions);
  return rate;
}

SpeedResult measure_speed(const SpeedConfig& config, const std::string& command) {
  SpeedResult result;
  result.threads = common::thread_count(config.threads);
  result.training_peak_mb = training_memory_mb(config, result.threads);  // before anything else takes some
  result.machine = common::build_and_host_facts();
  result.blas_core = common::blas_core_name();
  result.kernels = inference::gemm_kernel_name();
  result.config = common::config_to_json(config);
  result.command = command;
  std::vector<Row> rows = rows_of(config, result.threads, result);
  ImageLatency latency(config);
  DecisionLatency decisions(config);
  common::Progress progress("bench speed", config.runs * static_cast<std::int64_t>(rows.size() + 2));
  std::int64_t done = 0;
  for (std::int64_t round = 0; round < config.runs; ++round) {
    for (Row& row : rows) {
      row.rounds.push_back(row.figure());
      progress.update(++done);
      if (common::interrupted()) throw common::Interrupted("bench speed: stopped; nothing was written");
    }
    latency.measure();
    progress.update(++done);
    decisions.measure();
    progress.update(++done);
  }
  progress.finish();
  for (const Row& row : rows) *row.place = rate_of(row.rounds, row.flop, rows[row.peak].rounds);
  for (auto& [environments, rate] : *result.mbs.scales) rate.ns_per_step = 1e9 / rate.median;
  result.pose = latency_of(latency.pose_ms, latency.missed);
  result.control = latency_of(latency.command_ms, latency.missed);
  result.planner_decision = latency_of(decisions.planner_ms, 0);
  result.policy_decision = latency_of(decisions.policy_ms, 0);
  return result;
}

}  // namespace lodestone::experiments
