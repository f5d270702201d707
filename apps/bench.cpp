#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "hil_figures.h"
#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/inference/gemm.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "paper_bench.h"
#include "speed_figures.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

constexpr std::array<std::int64_t, 4> kScales = {1024, 4096, 16384, 65536};  // environments of an MBS

using common::median;
using common::percentile;

/// A figure's rounds, and where it is compared with the BLAS, the BLAS' rounds beside them: a machine whose
/// pace changes changes both.
struct Row {
  std::string name, unit;
  double scale;  ///< what one unit of the table is
  RateFigure figure;
  double flop = 0.0;     ///< of one unit of work
  std::size_t peak = 0;  ///< row of the rate it is compared with; 0 is itself, the first one
  std::vector<double> rounds = {};

  double fraction(const std::vector<Row>& rows) const {
    if (flop == 0.0) return 0.0;
    std::vector<double> fractions;
    for (std::size_t i = 0; i < rounds.size(); ++i)
      fractions.push_back(rounds[i] * flop / rows[peak].rounds[i]);
    return median(fractions);
  }
  common::Json json() const {
    return {{"median", median(rounds)}, {"min", percentile(rounds, 0.0)}, {"max", percentile(rounds, 1.0)}};
  }
};

void print_row(const char* name, double middle, double least, double most, const std::string& unit,
               const std::string& note) {
  std::printf("%-36s %10.1f  (%.1f .. %.1f) %-18s %s\n", name, middle, least, most, unit.c_str(),
              note.c_str());
}

common::Json latency_json(const std::vector<double>& ms) {
  return {{"median_ms", median(ms)}, {"p99_ms", percentile(ms, 0.99)}, {"max_ms", percentile(ms, 1.0)}};
}

void bench_speed(const CommonOptions& options, const std::string& command) {
  auto config = resolve_config<SpeedConfig>(options);
  if (!options.out.empty())
    common::make_folders(options.out);  // a folder that cannot be made is found out now
  nets::use_one_blas_thread();
  const std::int64_t threads =
      config.threads > 0 ? config.threads : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
  if (config.segmenter.empty()) {
    session::SensingConfig shipped;
    choose_segmenter(shipped);
    config.segmenter = shipped.segmenter;
  }
  const double memory_mb = training_memory_mb(config, threads);  // before anything else takes some

  rl::Td3Config td3;
  td3.batch_size = config.td3_batch;
  rl::Td3Config reference = td3;
  reference.backend = rl::Td3Backend::kAutograd;
  enum : std::size_t {
    kSgemmOne,
    kSgemmAll,
    kGemmOne,
    kGemmAll,
    kTd3One,
    kTd3All,
    kAutograd,
    kMbsOne,
    kMbsAll,
    kRigOne,
    kRigAll,
    kScale
  };
  const double update_flop = td3_update_flop(td3);
  std::vector<Row> rows = {
      {"sgemm 256^3, 1 thread", "GFLOP/s", 1e9, sgemm_rate(config, 1)},
      {"sgemm 256^3, all threads", "GFLOP/s", 1e9, sgemm_rate(config, threads)},
      {"own product, bias, ReLU, 1 thread", "GFLOP/s", 1e9, gemm_rate(config, 1), 1.0, kSgemmOne},
      {"own product, bias, ReLU, all threads", "GFLOP/s", 1e9, gemm_rate(config, threads), 1.0, kSgemmAll},
      {"TD3, 1 thread", "updates/s", 1.0, td3_rate(config, td3, 1), update_flop, kSgemmOne},
      {"TD3, all threads", "updates/s", 1.0, td3_rate(config, td3, threads), update_flop, kSgemmAll},
      {"TD3, plain autograd, 1 thread", "updates/s", 1.0, td3_rate(config, reference, 1), update_flop,
       kSgemmOne},
      {"MBS, 1 thread", "thousand steps/s", 1e3, mbs_rate(config, config.mbs_environments, 1),
       mbs_step_flop(), kSgemmOne},
      {"MBS, all threads", "thousand steps/s", 1e3, mbs_rate(config, config.mbs_environments, threads),
       mbs_step_flop(), kSgemmAll},
      {"virtual rig, 1 thread", "control steps/s", 1.0, rig_rate(config, 1)},
      {"virtual rig, all threads", "control steps/s", 1.0, rig_rate(config, threads)},
  };
  for (const std::int64_t environments : kScales) {
    rows.push_back({"MBS of " + std::to_string(environments) + ", all threads", "thousand steps/s", 1e3,
                    mbs_rate(config, environments, threads), mbs_step_flop(), kSgemmAll});
  }
  ImageLatency latency(config);

  common::Progress progress("bench speed", config.runs * static_cast<std::int64_t>(rows.size() + 1));
  std::int64_t done = 0;
  for (std::int64_t round = 0; round < config.runs; ++round) {
    for (Row& row : rows) {
      row.rounds.push_back(row.figure());
      progress.update(++done);
      if (common::interrupted()) throw common::Interrupted("bench speed: stopped; nothing was written");
    }
    latency.measure();
    progress.update(++done);
  }
  progress.finish();

  common::Json facts = common::build_and_host_facts();
  std::printf(
      "%s, %lld threads, BLAS core %s, own kernels %s, commit %s, %lld rounds of %g s: median (least .. "
      "most)\n",
      facts["processor"].get<std::string>().c_str(), static_cast<long long>(threads),
      common::blas_core_name().c_str(), inference::gemm_kernel_name().c_str(),
      facts["git_commit"].get<std::string>().c_str(), static_cast<long long>(config.runs), config.run_s);
  for (const Row& row : rows) {
    char fraction[32] = "";
    if (row.flop > 0.0)
      std::snprintf(fraction, sizeof fraction, "%5.1f %% of sgemm", 100.0 * row.fraction(rows));
    print_row(row.name.c_str(), median(row.rounds) / row.scale, percentile(row.rounds, 0.0) / row.scale,
              percentile(row.rounds, 1.0) / row.scale, row.unit, fraction);
  }
  const std::string slow = common::slow_blas_note(common::blas_core_name(), median(rows[kSgemmOne].rounds),
                                                  median(rows[kGemmOne].rounds));
  if (!slow.empty()) common::log_warning(slow);
  const auto print_latency = [](const char* name, const std::vector<double>& ms) {
    char note[48];
    std::snprintf(note, sizeof note, "p99 %.1f ms", percentile(ms, 0.99));
    print_row(name, median(ms), percentile(ms, 0.0), percentile(ms, 1.0), "ms", note);
  };
  print_latency("image to pose, 1 thread", latency.pose_ms);
  print_latency("image to currents, 1 thread", latency.command_ms);
  std::printf("%-36s %10.1f  MB, most held while training with a full buffer of a million transitions\n",
              "memory", memory_mb);

  if (options.out.empty()) return;
  const auto figure = [&](std::size_t all, std::size_t one, const char* key) {
    common::Json json = {
        {key, median(rows[all].rounds)}, {"all_threads", rows[all].json()}, {"one_thread", rows[one].json()}};
    if (rows[all].flop > 0.0) {
      json["fraction_of_peak"] = rows[all].fraction(rows);
      json["fraction_of_peak_one_thread"] = rows[one].fraction(rows);
      json["flop"] = rows[all].flop;
    }
    return json;
  };
  common::Json result = {{"machine", facts},
                         {"blas_core", common::blas_core_name()},
                         {"kernels", inference::gemm_kernel_name()},
                         {"threads", threads},
                         {"config", common::config_to_json(config)},
                         {"command", command},
                         {"sgemm", figure(kSgemmAll, kSgemmOne, "flop_per_s")},
                         {"gemm", figure(kGemmAll, kGemmOne, "flop_per_s")},
                         {"td3", figure(kTd3All, kTd3One, "updates_per_s")},
                         {"mbs", figure(kMbsAll, kMbsOne, "steps_per_s")},
                         {"rig", figure(kRigAll, kRigOne, "steps_per_s")},
                         {"pose", latency_json(latency.pose_ms)},
                         {"control", latency_json(latency.command_ms)},
                         {"memory", {{"training_peak_mb", memory_mb}}}};
  result["td3"]["autograd_one_thread"] = rows[kAutograd].json();
  result["pose"]["images"] = latency.pose_ms.size();
  result["pose"]["missed"] = latency.missed;
  for (std::size_t i = 0; i < kScales.size(); ++i) {
    common::Json scale = rows[kScale + i].json();
    scale["ns_per_step"] = 1e9 / median(rows[kScale + i].rounds);
    result["mbs"]["by_environments"][std::to_string(kScales[i])] = scale;
  }
  common::write_file_atomically(options.out + "/speed.json", result.dump(2) + "\n");
}

}  // namespace

void add_bench(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb = program.add_subcommand("bench", "measure this machine");
  verb->require_subcommand(1);
  CLI::App* speed = verb->add_subcommand("speed",
                                         "rates of the matrix product, TD3, the MBS and the virtual rig, "
                                         "time from an image to a pose and to currents, "
                                         "memory of training; --out DIR also writes speed.json");
  auto options = std::make_shared<CommonOptions>();
  add_common_options(*speed, *options);
  speed->callback([options] {
    std::string command = "lodestone bench speed";
    for (const Override& value : options->overrides) command += " --set " + value.assignment;
    if (options->threads) command += " --threads " + std::to_string(*options->threads);
    bench_speed(*options, command);
  });
  add_bench_hil(*verb, catalogue);
  add_bench_paper(*verb, catalogue);
  catalogue["bench speed"] = [options] { return describe_resolved<SpeedConfig>(*options); };
}

}  // namespace lodestone::apps
