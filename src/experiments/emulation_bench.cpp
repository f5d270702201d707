#include "lodestone/experiments/emulation_bench.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/emulation/lockstep_port.h"
#include "lodestone/experiments/busy_processors.h"
#include "lodestone/experiments/emulated_rig.h"
#include "lodestone/experiments/pulse_watch.h"
#include "lodestone/rig/serial_coils.h"

namespace lodestone::experiments {
namespace {

using common::percentile;

/// The coils behind the whole chain, in simulated time.
struct LockstepDrive {
  LockstepDrive(rig::VirtualRig& rig, const rig::SerialConfig& serial)
      : bench(rig), coils(serial, rig.config().coils, [this] {
          return std::make_unique<emulation::LockstepPort>(bench);
        }) {}
  emulation::EmulatedBench bench;
  rig::SerialCoils coils;
};

double mean_error_mm(const std::vector<TrialResult>& results) {
  double sum = 0.0;
  for (const TrialResult& result : results) sum += result.truth->error_mm();
  return sum / static_cast<double>(results.size());
}

std::vector<TrialPlan> square_plans(const EmulationBenchConfig& config, const Deployment& deployment) {
  std::vector<TrialPlan> plans;
  for (std::int64_t index = 0; index < config.deployment.trials.count; ++index)
    plans.push_back(plan_trial(config.deployment, "square", index, std::nullopt, std::nullopt,
                               [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
  return plans;
}

ControllerSource source_of(const EmulationBenchConfig& config) {
  std::optional<SimulatorSource> simulator;
  if (!config.dynamics.empty()) simulator = load_simulator(config.deployment, config.dynamics);
  if (!config.policy.empty())
    return policy_source(config.deployment, inference::load_policy(config.policy), config.policy,
                         simulator ? &*simulator : nullptr);
  return simulator ? planner_source(config.deployment, *simulator) : baseline_source(config.deployment);
}

}  // namespace

EmulationBench::EmulationBench(const EmulationBenchConfig& config, std::string folder)
    : config_(config),
      folder_(std::move(folder)),
      seed_(static_cast<std::uint64_t>(config.deployment.seed)),
      source_(source_of(config)) {
  result_.machine = common::build_and_host_facts();
}

void EmulationBench::add(const std::string& figure, double value, const char* unit, double bound) {
  result_.figures.push_back(at_most(figure, value, unit, bound));
}

void EmulationBench::time_round_trips() {
  emulation::LiveBench bench(config_.deployment.rig, seed_);
  rig::SerialConfig serial = config_.deployment.rig.serial;
  serial.port = bench.port();
  rig::SerialCoils coils(serial, config_.deployment.rig.coils);
  const common::SteadyClock clock;
  std::vector<double> ping_ms;
  std::vector<double> status_ms;
  for (std::int64_t i = 0; i < config_.round_trips; ++i) {
    const double start_s = clock.now_s();
    coils.ping();
    const double pinged_s = clock.now_s();
    coils.status();
    ping_ms.push_back(1e3 * (pinged_s - start_s));
    status_ms.push_back(1e3 * (clock.now_s() - pinged_s));
  }
  result_.round_trip = {percentile(ping_ms, 0.5), percentile(ping_ms, 0.99), percentile(status_ms, 0.5),
                        percentile(status_ms, 0.99), bench.lost_s()};
  add("round trip at 115,200 baud, median", result_.round_trip->ping_median_ms, "ms",
      config_.round_trip_bound_ms);
}

void EmulationBench::drive_in_real_time() {
  result_.real_time = drive_squares("in real time", folders("real_time"));
  const BusyProcessors busy;
  result_.under_load = drive_squares("on a busy machine", folders("under_load"));
}

TrialFolders EmulationBench::folders(const std::string& name) const {
  TrialFolders made;
  if ((made.mcap = config_.mcap).enabled) common::make_folders(made.logs = folder_ + "/logs/" + name);
  return made;
}

RealTimeSquares EmulationBench::drive_squares(const std::string& how, const TrialFolders& folders) {
  RealTimeSquares squares;
  std::vector<double> deviations_ms;
  double unfinished = 0.0;
  for (std::int64_t index = 0; index < config_.timed_squares; ++index) {
    if (common::interrupted()) throw common::Interrupted("bench emulation: stopped by the user");
    const std::vector<double> of_one = drive_square(index, how, folders, squares);
    deviations_ms.insert(deviations_ms.end(), of_one.begin(), of_one.end());
    if (!squares.stop_reason.empty()) ++unfinished;
  }
  squares.cross_track_rms_mm /= static_cast<double>(squares.squares);
  static_cast<PeriodDeviation&>(squares) = PeriodDeviation(deviations_ms);
  add("control period " + how + ": deviation, p99", squares.deviation_p99_ms, "ms", config_.jitter_bound_ms);
  add("squares " + how + ": not finished", unfinished, "", 0.0);
  return squares;
}

std::vector<double> EmulationBench::drive_square(std::int64_t index, const std::string& how,
                                                 const TrialFolders& folders, RealTimeSquares& squares) {
  DeploymentConfig deployment = config_.deployment;
  const EmulatedRig emulated =
      make_emulated_rig(deployment.rig, static_cast<std::uint64_t>(deployment.rig_seed),
                        &deployment.sensor.scene, static_cast<std::uint64_t>(deployment.sensor_seed));
  emulation::LiveBench& live = *emulated.bench;
  deployment.rig = emulated.description;
  deployment.safety.stop_file = folder_ + "/STOP";
  PulseWatch watch(live);
  const std::unique_ptr<session::RigSession> session =
      session::make_bench_session(deployment.rig, deployment.sensor, deployment.safety);
  const TrialPlan plan = plan_trial(deployment, "square", index, std::nullopt, std::nullopt,
                                    [&](const geometry::Pose2& pose) { return session->fits(pose); });
  live.place(plan.start);
  common::log_info("bench emulation: square " + std::to_string(index + 1) + " of " +
                   std::to_string(config_.timed_squares) + " " + how + " on " + live.port() + " under " +
                   live.camera());
  TrialRecording recording(folders, deployment.record,
                           {trial_name(RigKind::kReal, source_, plan),
                            plan,
                            {session->clock(), session->coils(), session->camera()},
                            deployment.rig,
                            deployment.loop.period_s(),
                            source_.action.scale,
                            true});
  const TrialResult trial = run_on_session(
      *session, deployment, plan, source_, [&] { return live.true_pose(); },
      [&recording](const TrialSample& sample) { recording.show(sample); });
  recording.finish(trial);
  if (!trial.completed) common::log_warning("square " + how + " stopped: " + trial.stop_reason);
  ++squares.squares;
  squares.pulses += watch.pulses();
  squares.cross_track_rms_mm += mean_error_mm({trial});
  squares.lost_real_time_s += live.lost_s();
  squares.stop_reason = trial.stop_reason;
  return watch.deviations_ms(deployment.loop.period_s());
}

void EmulationBench::compare_squares() {
  common::ThreadPool pool(static_cast<std::size_t>(config_.threads));
  const rig::SerialConfig serial = config_.deployment.rig.serial;
  const Deployment simulated(config_.deployment);
  const Deployment emulated(config_.deployment, [serial](rig::VirtualRig& rig) {
    auto drive = std::make_shared<LockstepDrive>(rig, serial);
    return RigDrive{&drive->coils, &drive->bench.clock(), drive};
  });
  const std::vector<TrialPlan> plans = square_plans(config_, simulated);
  common::log_info("bench emulation: " + std::to_string(plans.size()) +
                   " squares with simulated coils, then as many with "
                   "the emulated bench");
  const double simulated_mm =
      mean_error_mm(simulated.run(plans, RigKind::kExplored, source_, pool, false, folders("simulated")));
  const auto by_bench = emulated.run(plans, RigKind::kExplored, source_, pool, false, folders("emulated"));
  double stopped = 0.0;
  for (const TrialResult& trial : by_bench) {
    if (trial.completed) continue;
    stopped += 1.0;
    common::log_warning("square stopped: " + trial.stop_reason);
  }
  const double emulated_mm = mean_error_mm(by_bench);
  result_.square = {simulated_mm, emulated_mm, static_cast<std::int64_t>(plans.size()), std::nullopt};
  if (!config_.deployment.rig.amplifier.ideal()) {
    DeploymentConfig at_once = config_.deployment;
    at_once.rig.amplifier = physics::AmplifierConfig{};
    common::log_info("bench emulation: the same with simulated coils whose drivers follow at once");
    const Deployment ideal(at_once);
    result_.square->ideal_mm =
        mean_error_mm(ideal.run(plans, RigKind::kExplored, source_, pool, false, folders("ideal")));
  }
  add("square: relative difference of the mean error", std::abs(emulated_mm / simulated_mm - 1.0), "",
      config_.error_bound);
  add("square: trials stopped on the emulated bench", stopped, "", 0.0);
}

void EmulationBench::inject_every_fault() {
  const std::vector<std::string> names = fault_names();
  common::Progress progress("faults", static_cast<std::int64_t>(names.size()));
  double lost = 0.0;
  for (const std::string& name : names) {
    if (common::interrupted()) throw common::Interrupted("bench emulation: stopped by the user");
    result_.faults.push_back(inject_fault(name, seed_, folder_));
    lost += static_cast<double>(result_.faults.back().steps - result_.faults.back().recorded);
    progress.update(static_cast<std::int64_t>(result_.faults.size()), name);
  }
  progress.finish();
  for (const std::string& name : device_fault_names())
    result_.faults.push_back(inject_held_fault(name, seed_, folder_));
  double worst_s = 0.0;
  double unsafe = 0.0;
  for (const FaultResult& result : result_.faults) {
    worst_s = std::max(worst_s, result.on_after_s);
    unsafe += result.unsafe ? 1.0 : 0.0;
  }
  add("longest time to coils off after a fault", worst_s, "s", kOffWithin_s);
  add("faults with an unsafe state", unsafe, "", 0.0);
  add("records lost", lost, "", 0.0);
}

void EmulationBench::inject_for_long() {
  if (config_.pulses == 0) return;
  common::log_info("bench emulation: " + std::to_string(config_.pulses) + " pulses with a fault a minute");
  result_.long_run = inject_for_an_hour(config_.pulses, seed_, folder_);
  const HourReport& report = *result_.long_run;
  double unlogged = 0.0;
  for (const FaultResult& fault : report.faults) unlogged += fault.reason.empty() ? 1.0 : 0.0;
  add("long run: unsafe states", static_cast<double>(report.unsafe), "", 0.0);
  add("long run: faults without an entry in the log", unlogged, "", 0.0);
  add("long run: longest stretch with current", report.longest_on_s, "s", kOffWithin_s);
}

}  // namespace lodestone::experiments
