#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/clock.h"
#include "lodestone/common/files.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/nets/blas.h"
#include "lodestone/nets/dynamics.h"
#include "lodestone/rig/rig_batch.h"
#include "lodestone/rl/td3.h"
#include "lodestone/task/action.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

struct BenchConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::int64_t runs = 5;
  double run_s = 1.0;
  std::int64_t td3_batch = 256;
  std::int64_t mbs_environments = 4096;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the inputs", {0, 9e15});
    v.field("threads", threads, "", "threads of the threaded figures; 0 means one per processor", {0, 1024});
    v.field("runs", runs, "", "runs of each figure; the median is quoted", {1, 100});
    v.field("run_s", run_s, "s", "least time of one run", {0.01, 600.0});
    v.field("td3_batch", td3_batch, "transitions", "batch of one TD3 update", {2, 1 << 20});
    v.field("mbs_environments", mbs_environments, "", "environments stepped as one batch", {1, 1 << 22});
  }
};

/// Median and extremes of a rate over several runs.
struct Rate {
  double median = 0.0;
  double least = 0.0;
  double most = 0.0;
};

/// Calls `work`, which does `units` of work, for at least run_s in each run.
template <class Work>
Rate measure(const BenchConfig& config, double units, const Work& work) {
  const common::SteadyClock clock;
  work();  // warm-up: caches, buffers, threads
  std::vector<double> rates;
  for (std::int64_t run = 0; run < config.runs; ++run) {
    const double start_s = clock.now_s();
    double done = 0.0;
    double elapsed_s = 0.0;
    do {
      work();
      done += units;
      elapsed_s = clock.now_s() - start_s;
    } while (elapsed_s < config.run_s);
    rates.push_back(done / elapsed_s);
  }
  std::sort(rates.begin(), rates.end());
  return {rates[rates.size() / 2], rates.front(), rates.back()};
}

common::Json to_json(const Rate& rate) {
  return {{"median", rate.median}, {"min", rate.least}, {"max", rate.most}};
}

/// What this machine's BLAS reaches on the matrix product that dominates the networks: 256 x 256 x 256,
/// float32.
Rate measure_sgemm(const BenchConfig& config, common::ThreadPool& pool) {
  constexpr std::int64_t kSize = 256;
  constexpr int kProducts = 50;
  struct Operands {
    torch::Tensor a = torch::randn({kSize, kSize});
    torch::Tensor b = torch::randn({kSize, kSize});
    torch::Tensor c = torch::empty({kSize, kSize});
  };
  std::vector<Operands> operands(pool.size());
  const double flop = 2.0 * kSize * kSize * kSize * kProducts * static_cast<double>(pool.size());
  return measure(config, flop, [&] {
    pool.for_each(pool.size(), [&](std::size_t shard) {
      const torch::NoGradGuard no_grad;
      Operands& mine = operands[shard];
      for (int i = 0; i < kProducts; ++i) torch::mm_out(mine.c, mine.a, mine.b);
    });
  });
}

double layer_flop(const std::vector<std::int64_t>& sizes) {
  double flop = 0.0;
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    flop += 2.0 * static_cast<double>(sizes[i - 1]) * static_cast<double>(sizes[i]);
  }
  return flop;
}

constexpr std::int64_t kObservationSize = 5;  // the paper's networks: state and target
constexpr std::int64_t kActionSize = 2;

/// Matrix products of one TD3 update: targets forward (actor, twin critics), twin critics forward and
/// backward, and at every second update the actor forward and backward through the first critic.
double td3_update_flop(const rl::Td3Config& td3) {
  const double actor = layer_flop({kObservationSize, td3.hidden[0], td3.hidden[1], kActionSize});
  const double critic = layer_flop({kObservationSize + kActionSize, td3.hidden[0], td3.hidden[1], 1});
  const double policy = (3.0 * actor + 2.0 * critic) / static_cast<double>(td3.policy_frequency);
  return static_cast<double>(td3.batch_size) * (actor + 2.0 * critic + 6.0 * critic + policy);
}

Rate measure_td3(const BenchConfig& config, const rl::Td3Config& td3, std::int64_t threads) {
  constexpr int kUpdates = 20;
  const auto learner =
      rl::make_td3(td3, kObservationSize, kActionSize, static_cast<std::uint64_t>(config.seed), threads);
  rl::Batch batch(td3.batch_size, kObservationSize, kActionSize);
  torch::manual_seed(config.seed);
  for (torch::Tensor* tensor : {&batch.observation, &batch.action, &batch.reward, &batch.next_observation}) {
    tensor->uniform_(-1.0, 1.0);
  }
  batch.not_done.fill_(1.0);
  const torch::Tensor noise = 0.2 * torch::randn({td3.batch_size, kActionSize});
  return measure(config, kUpdates, [&] {
    for (int i = 0; i < kUpdates; ++i) learner->update(batch, noise);
  });
}

/// The paper's dynamics network with weights as drawn: the time does not depend on what was learned.
nets::DynamicsModel drawn_model(const BenchConfig& config) {
  torch::manual_seed(config.seed);
  nets::DynamicsModel model;
  model.members.emplace_back(nets::DynamicsNetwork(model.config, model.info.layout));
  model.members.front()->eval();
  model.start_states = 0.02 * (torch::rand({1000, 3}, torch::kFloat64) - 0.5);
  return model;
}

Rate measure_mbs(const BenchConfig& config, std::int64_t threads) {
  constexpr int kSteps = 10;
  const nets::DynamicsModel model = drawn_model(config);
  env::EpisodeSettings settings;
  settings.count = config.mbs_environments;
  settings.seed = static_cast<std::uint64_t>(config.seed);
  env::MbsEnv environments(model, settings, env::MbsConfig{}, threads);
  environments.reset();
  const torch::Tensor actions = 2.0 * torch::rand({config.mbs_environments, kActionSize}) - 1.0;
  return measure(config, static_cast<double>(kSteps * config.mbs_environments), [&] {
    for (int i = 0; i < kSteps; ++i) environments.step(actions);
  });
}

/// Control steps of virtual rigs, each 100 ms of pulse and 200 ms of rest with random currents.
Rate measure_rig(const BenchConfig& config, common::ThreadPool& pool) {
  constexpr std::size_t kRigs = 16;
  constexpr int kSteps = 20;
  const rig::VirtualRigConfig rig_config;
  std::vector<std::unique_ptr<rig::VirtualRig>> rigs;
  std::vector<rig::VirtualRig*> pointers;
  for (std::size_t i = 0; i < kRigs; ++i) {
    rigs.push_back(std::make_unique<rig::VirtualRig>(rig_config, static_cast<std::uint64_t>(config.seed) + i,
                                                     i == 0 ? nullptr : rigs[0]->field_table()));
    pointers.push_back(rigs.back().get());
  }
  common::RandomStream random(static_cast<std::uint64_t>(config.seed), "bench-currents");
  std::vector<rig::CoilPulse> pulses(kRigs);
  return measure(config, static_cast<double>(kRigs * kSteps), [&] {
    for (rig::VirtualRig* rig : pointers) rig->place({0.0, 0.0, random.uniform(-3.0, 3.0)});
    for (int step = 0; step < kSteps; ++step) {
      for (rig::CoilPulse& pulse : pulses) {
        pulse.current_A = task::coil_currents({random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)});
        pulse.duration_s = 0.1;
      }
      rig::run_pulses(pointers, pulses, 0.2, pool);
    }
  });
}

void print_row(const char* what, const Rate& rate, double scale, const char* unit, double fraction) {
  char share[32] = "";
  if (fraction > 0.0) std::snprintf(share, sizeof share, "%5.1f %% of sgemm", 100.0 * fraction);
  std::printf("%-34s %10.1f  (%.1f .. %.1f) %-18s %s\n", what, rate.median / scale, rate.least / scale,
              rate.most / scale, unit, share);
}

void bench_speed(const CommonOptions& options, const std::string& command) {
  const auto config = resolve_config<BenchConfig>(options);
  nets::use_one_blas_thread();
  const std::int64_t threads =
      config.threads > 0 ? config.threads : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
  common::ThreadPool one(1);
  common::ThreadPool all(static_cast<std::size_t>(threads));
  rl::Td3Config td3;
  td3.batch_size = config.td3_batch;
  const nets::DynamicsConfig paper;
  std::vector<std::int64_t> sizes{5};
  sizes.insert(sizes.end(), paper.hidden.begin(), paper.hidden.end());
  sizes.push_back(3);
  const double mbs_flop = layer_flop(sizes);

  common::Progress progress("bench speed", 8);
  std::int64_t done = 0;
  const auto next = [&](Rate rate) {
    progress.update(++done);
    return rate;
  };
  const Rate peak_one = next(measure_sgemm(config, one));
  const Rate peak_all = next(measure_sgemm(config, all));
  const Rate td3_one = next(measure_td3(config, td3, 1));
  const Rate td3_all = next(measure_td3(config, td3, threads));
  const Rate mbs_one = next(measure_mbs(config, 1));
  const Rate mbs_all = next(measure_mbs(config, threads));
  const Rate rig_one = next(measure_rig(config, one));
  const Rate rig_all = next(measure_rig(config, all));
  progress.finish();

  const double td3_flop = td3_update_flop(td3);
  common::Json facts = common::build_and_host_facts();
  std::printf("%s, %lld threads, BLAS core %s, commit %s, %lld runs of %g s: median (least .. most)\n",
              facts["processor"].get<std::string>().c_str(), static_cast<long long>(threads),
              nets::blas_core_name().c_str(), facts["git_commit"].get<std::string>().c_str(),
              static_cast<long long>(config.runs), config.run_s);
  const auto share = [](const Rate& rate, double flop, const Rate& peak) {
    return rate.median * flop / peak.median;
  };
  print_row("sgemm 256^3, 1 thread", peak_one, 1e9, "GFLOP/s", 0.0);
  print_row("sgemm 256^3, all threads", peak_all, 1e9, "GFLOP/s", 0.0);
  print_row("TD3, 1 thread", td3_one, 1.0, "updates/s", share(td3_one, td3_flop, peak_one));
  print_row("TD3, all threads", td3_all, 1.0, "updates/s", share(td3_all, td3_flop, peak_all));
  print_row("MBS, 1 thread", mbs_one, 1e3, "thousand steps/s", share(mbs_one, mbs_flop, peak_one));
  print_row("MBS, all threads", mbs_all, 1e3, "thousand steps/s", share(mbs_all, mbs_flop, peak_all));
  print_row("virtual rig, 1 thread", rig_one, 1.0, "control steps/s", 0.0);
  print_row("virtual rig, all threads", rig_all, 1.0, "control steps/s", 0.0);

  if (options.out.empty()) return;
  const auto figure = [&](const Rate& one_thread, const Rate& all_threads, const char* key, double flop) {
    common::Json json = {{key, all_threads.median},
                         {"all_threads", to_json(all_threads)},
                         {"one_thread", to_json(one_thread)}};
    if (flop > 0.0) {
      json["fraction_of_peak"] = share(all_threads, flop, peak_all);
      json["flop"] = flop;
    }
    return json;
  };
  const common::Json result = {{"machine", facts},
                               {"blas_core", nets::blas_core_name()},
                               {"threads", threads},
                               {"config", common::config_to_json(config)},
                               {"command", command},
                               {"sgemm", figure(peak_one, peak_all, "flop_per_s", 0.0)},
                               {"td3", figure(td3_one, td3_all, "updates_per_s", td3_flop)},
                               {"mbs", figure(mbs_one, mbs_all, "steps_per_s", mbs_flop)},
                               {"rig", figure(rig_one, rig_all, "steps_per_s", 0.0)}};
  common::make_folders(options.out);
  common::write_file_atomically(options.out + "/speed.json", result.dump(2) + "\n");
}

}  // namespace

void add_bench(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb = program.add_subcommand("bench", "measure this machine");
  verb->require_subcommand(1);
  CLI::App* speed = verb->add_subcommand(
      "speed",
      "rates of the matrix product, TD3, the MBS and the virtual rig; --out DIR also writes speed.json");
  auto options = std::make_shared<CommonOptions>();
  add_common_options(*speed, *options);
  speed->callback([options] {
    std::string command = "lodestone bench speed";
    for (const std::string& assignment : options->overrides) command += " --set " + assignment;
    if (options->threads) command += " --threads " + std::to_string(*options->threads);
    bench_speed(*options, command);
  });
  catalogue["bench"] = [] { return common::describe_config<BenchConfig>(); };
}

}  // namespace lodestone::apps
