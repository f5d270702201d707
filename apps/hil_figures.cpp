#include "hil_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <mutex>
#include <vector>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/statistics.h"
#include "lodestone/emulation/live_bench.h"
#include "lodestone/emulation/lockstep_port.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/fault_injection.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/blas.h"
#include "lodestone/runs/run_folder.h"
#include "models.h"

namespace lodestone::apps {
namespace {

struct HilConfig {
  experiments::DeploymentConfig deployment;
  std::int64_t threads = 0;
  std::string policy;
  std::int64_t pulses = 12000;
  std::int64_t round_trips = 500;
  double round_trip_bound_ms = 5.0;
  double jitter_bound_ms = 5.0;
  double error_bound = 0.1;

  HilConfig() {
    deployment.trials.count = 20;
    deployment.loop.rest_s = 0.2333;  // a period of a third of a second
    deployment.loop.decide_s = 0.12;
  }
  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("policy", policy, "", "folder of the policy checkpoint; empty: the proportional baseline drives");
    v.field("pulses", pulses, "",
            "pulses of the run with a random fault a minute; 12000 take an hour of bench time", {0, 1e6});
    v.field("round_trips", round_trips, "", "answers of the firmware to time", {10, 100000});
    v.field("round_trip_bound_ms", round_trip_bound_ms, "ms", "median of the way there and back",
            {0.1, 1000.0});
    v.field("jitter_bound_ms", jitter_bound_ms, "ms", "99th percentile of the period's deviation",
            {0.1, 1000.0});
    v.field("error_bound", error_bound, "",
            "largest relative difference from the simulated coils' mean error", {0.0, 10.0});
  }
};

experiments::ControllerSource source_of(const HilConfig& config) {
  if (config.policy.empty()) return experiments::baseline_source(config.deployment);
  return experiments::policy_source(config.deployment, inference::load_policy(config.policy), config.policy);
}

using common::percentile;

/// Collects figures and what they must keep to.
class Figures {
 public:
  void add(const std::string& name, double value, const char* unit, double bound) {
    const bool good = value <= bound;
    std::printf("%-52s %9.3f %-3s bound %.3f  %s\n", name.c_str(), value, unit, bound,
                good ? "ok" : "BROKEN");
    std::fflush(stdout);
    json_.push_back({{"figure", name}, {"value", value}, {"unit", unit}, {"bound", bound}, {"ok", good}});
    if (!good) broken_.push_back(name);
  }
  common::Json take() { return std::move(json_); }
  const std::vector<std::string>& broken() const { return broken_; }

 private:
  common::Json json_ = common::Json::array();
  std::vector<std::string> broken_;
};

common::Json to_json(const experiments::FaultResult& result) {
  return {{"fault", result.fault},   {"injected_s", result.injected_s}, {"stopped", result.stopped},
          {"reason", result.reason}, {"on_after_s", result.on_after_s}, {"unsafe", result.unsafe},
          {"steps", result.steps},   {"recorded", result.recorded}};
}

common::Json run_fault_list(const HilConfig& config, const std::string& out, Figures& figures) {
  common::Json json = common::Json::array();
  const std::vector<std::string> names = experiments::fault_names();
  common::Progress progress("faults", static_cast<std::int64_t>(names.size()));
  double worst_s = 0.0;
  double unsafe = 0.0;
  double lost = 0.0;
  std::int64_t done = 0;
  for (const std::string& name : names) {
    if (common::interrupted()) throw common::Interrupted("bench hil: stopped by the user");
    const experiments::FaultResult result =
        experiments::inject_fault(name, static_cast<std::uint64_t>(config.deployment.seed), out);
    worst_s = std::max(worst_s, result.on_after_s);
    unsafe += result.unsafe ? 1.0 : 0.0;
    lost += static_cast<double>(result.steps - result.recorded);
    json.push_back(to_json(result));
    progress.update(++done, name);
  }
  progress.finish();
  for (const common::Json& one : json)
    std::printf("  %-34s %-8s off after %.3f s  %s\n", one["fault"].get<std::string>().c_str(),
                one["stopped"].get<bool>() ? "stopped" : "went on", one["on_after_s"].get<double>(),
                one["reason"].get<std::string>().c_str());
  for (const std::string& name : experiments::device_fault_names()) {
    const experiments::FaultResult held =
        experiments::inject_held_fault(name, static_cast<std::uint64_t>(config.deployment.seed), out);
    std::printf("  %-34s in a pulse of seconds: off after %.3f s  %s\n", name.c_str(), held.on_after_s,
                held.reason.c_str());
    worst_s = std::max(worst_s, held.on_after_s);
    unsafe += held.unsafe ? 1.0 : 0.0;
    common::Json one = to_json(held);
    one["held"] = true;
    json.push_back(one);
  }
  figures.add("longest time to coils off after a fault", worst_s, "s", experiments::kOffWithin_s);
  figures.add("faults with an unsafe state", unsafe, "", 0.0);
  figures.add("records lost", lost, "", 0.0);
  return json;
}

common::Json run_hour(const HilConfig& config, const std::string& out, Figures& figures) {
  if (config.pulses == 0) return nullptr;
  common::log_info("bench hil: " + std::to_string(config.pulses) + " pulses with a fault a minute");
  const experiments::HourReport report =
      experiments::inject_for_an_hour(config.pulses, static_cast<std::uint64_t>(config.deployment.seed), out);
  common::Json log = common::Json::array();
  double unlogged = 0.0;
  for (const experiments::FaultResult& fault : report.faults) {
    log.push_back(to_json(fault));
    unlogged += fault.reason.empty() ? 1.0 : 0.0;
  }
  std::printf("  %lld pulses in %.0f s of bench time, %zu faults, largest current %.1f A\n",
              static_cast<long long>(report.pulses), report.simulated_s, report.faults.size(),
              report.largest_current_A);
  figures.add("long run: unsafe states", static_cast<double>(report.unsafe), "", 0.0);
  figures.add("long run: faults without an entry in the log", unlogged, "", 0.0);
  figures.add("long run: longest stretch with current", report.longest_on_s, "s", experiments::kOffWithin_s);
  return {{"pulses", report.pulses},
          {"simulated_s", report.simulated_s},
          {"largest_current_A", report.largest_current_A},
          {"faults", log}};
}

common::Json time_round_trips(const HilConfig& config, Figures& figures) {
  emulation::LiveBench bench(config.deployment.rig, static_cast<std::uint64_t>(config.deployment.seed));
  rig::SerialConfig serial = config.deployment.rig.serial;
  serial.port = bench.port();
  rig::SerialCoils coils(serial, config.deployment.rig.coils);
  const common::SteadyClock clock;
  std::vector<double> ping_ms;
  std::vector<double> status_ms;
  for (std::int64_t i = 0; i < config.round_trips; ++i) {
    double start_s = clock.now_s();
    coils.ping();
    ping_ms.push_back(1e3 * (clock.now_s() - start_s));
    start_s = clock.now_s();
    coils.status();
    status_ms.push_back(1e3 * (clock.now_s() - start_s));
  }
  figures.add("round trip at 115,200 baud, median", percentile(ping_ms, 0.5), "ms",
              config.round_trip_bound_ms);
  std::printf("  round trip p99 %.2f ms; with the whole status median %.2f ms, p99 %.2f ms\n",
              percentile(ping_ms, 0.99), percentile(status_ms, 0.5), percentile(status_ms, 0.99));
  return {{"ping_median_ms", percentile(ping_ms, 0.5)},
          {"ping_p99_ms", percentile(ping_ms, 0.99)},
          {"status_median_ms", percentile(status_ms, 0.5)},
          {"status_p99_ms", percentile(status_ms, 0.99)},
          {"lost_real_time_s", bench.lost_s()}};
}

/// The coils behind the whole chain, in simulated time.
struct LockstepDrive {
  LockstepDrive(rig::VirtualRig& rig, const rig::SerialConfig& serial)
      : bench(rig), coils(serial, rig.config().coils, [this] {
          return std::make_unique<emulation::LockstepPort>(bench);
        }) {}
  emulation::EmulatedBench bench;
  rig::SerialCoils coils;
};

double mean_error_mm(const std::vector<experiments::TrialResult>& results) {
  double sum = 0.0;
  for (const experiments::TrialResult& result : results)
    sum += 1e3 * result.truth->cross_track_rms_m.value_or(result.truth->final_error_m);
  return sum / static_cast<double>(results.size());
}

std::vector<experiments::TrialPlan> square_plans(const HilConfig& config,
                                                 const experiments::Deployment& deployment) {
  std::vector<experiments::TrialPlan> plans;
  for (std::int64_t index = 0; index < config.deployment.trials.count; ++index)
    plans.push_back(
        experiments::plan_trial(config.deployment, "square", index, std::nullopt, std::nullopt,
                                [&](const geometry::Pose2& pose) { return deployment.fits(pose); }));
  return plans;
}

/// The same squares through the simulated coils and through the emulated bench.
common::Json compare_squares(const HilConfig& config, Figures& figures) {
  const experiments::ControllerSource source = source_of(config);
  common::ThreadPool pool(static_cast<std::size_t>(config.threads));
  const rig::SerialConfig serial = config.deployment.rig.serial;
  const experiments::Deployment simulated(config.deployment);
  const experiments::Deployment emulated(config.deployment, [serial](rig::VirtualRig& rig) {
    auto drive = std::make_shared<LockstepDrive>(rig, serial);
    return experiments::RigDrive{&drive->coils, &drive->bench.clock(), drive};
  });
  const std::vector<experiments::TrialPlan> plans = square_plans(config, simulated);
  common::log_info("bench hil: " + std::to_string(plans.size()) +
                   " squares with simulated coils, then as many with "
                   "the emulated bench");
  const auto by_simulation = simulated.run(plans, experiments::RigKind::kExplored, source, pool);
  const auto by_bench = emulated.run(plans, experiments::RigKind::kExplored, source, pool);
  double stopped = 0.0;
  for (const experiments::TrialResult& result : by_bench) {
    stopped += result.completed ? 0.0 : 1.0;
    if (!result.completed) common::log_warning("square stopped: " + result.stop_reason);
  }
  const double simulated_mm = mean_error_mm(by_simulation);
  const double emulated_mm = mean_error_mm(by_bench);
  std::printf(
      "  square, cross-track RMS: %.3f mm with simulated coils, %.3f mm through the firmware (n = %zu)\n",
      simulated_mm, emulated_mm, plans.size());
  figures.add("square: relative difference of the mean error", std::abs(emulated_mm / simulated_mm - 1.0), "",
              config.error_bound);
  figures.add("square: trials stopped on the emulated bench", stopped, "", 0.0);
  return {{"simulated_mm", simulated_mm}, {"emulated_mm", emulated_mm}, {"trials", plans.size()}};
}

/// One square in real time: pseudo-terminal, GigE Vision camera, U-Net, controller.
common::Json run_live(const HilConfig& config, const std::string& out, Figures& figures) {
  experiments::DeploymentConfig deployment = config.deployment;
  imaging::SceneConfig scene = deployment.sensor.scene;
  scene.bench = rig::bench_of(deployment.rig);
  const auto renderer = std::make_shared<const imaging::SceneRenderer>(
      imaging::draw_scene(scene, static_cast<std::uint64_t>(deployment.sensor_seed)));
  emulation::LiveBench live(deployment.rig, static_cast<std::uint64_t>(deployment.rig_seed), renderer);
  deployment.rig.backend = rig::Backend::kSerial;
  deployment.rig.serial.port = live.port();
  rig::CameraSourceConfig& camera = deployment.rig.camera;
  camera.kind = rig::CameraKind::kGenicam;
  camera.source = live.camera();
  camera.pixel_format = "RGB8";
  camera.width_px = renderer->scene().camera.width_px;
  camera.height_px = renderer->scene().camera.height_px;
  camera.frame_rate_hz = 20.0;
  deployment.safety.stop_file = out + "/STOP";

  std::mutex mutex;
  std::vector<double> begun_s;
  live.with([&](emulation::EmulatedBench& bench) {
    bench.watch = [&, was_on = false](double now_s, const auto&) mutable {
      bool on = false;
      for (int i = 0; i < 2; ++i)
        for (const double duty : bench.controller(i).duty()) on = on || duty != 0.0;
      if (on && !was_on) {
        const std::lock_guard<std::mutex> lock(mutex);
        begun_s.push_back(now_s);
      }
      was_on = on;
    };
  });
  const std::unique_ptr<session::RigSession> bench =
      session::make_serial_session(deployment.rig, deployment.sensor, deployment.safety);
  const experiments::TrialPlan plan =
      experiments::plan_trial(deployment, "square", 0, std::nullopt, std::nullopt,
                              [&](const geometry::Pose2& pose) { return bench->fits(pose); });
  live.place(plan.start);
  common::log_info("bench hil: one square in real time on " + live.port() + " under " + live.camera());
  const experiments::TrialResult result = experiments::run_on_session(
      *bench, deployment, plan, source_of(config), [&] { return live.true_pose(); });
  live.with([](emulation::EmulatedBench& emulated) { emulated.watch = nullptr; });
  const double period_s = deployment.loop.period_s();
  std::vector<double> deviation_ms;
  for (std::size_t i = 1; i < begun_s.size(); ++i) {
    const double periods = std::round((begun_s[i] - begun_s[i - 1]) / period_s);
    if (periods >= 1.0)  // a step without a pose or with a drive of zero gives no pulse
      deviation_ms.push_back(1e3 * std::abs(begun_s[i] - begun_s[i - 1] - periods * period_s));
  }
  if (!result.completed) common::log_warning("real-time square stopped: " + result.stop_reason);
  const double error_mm = mean_error_mm({result});
  std::printf(
      "  real-time square: %zu pulses, cross-track RMS %.2f mm, period %.1f ms, deviation median %.2f ms, "
      "real time lost %.2f s\n",
      begun_s.size(), error_mm, 1e3 * period_s, percentile(deviation_ms, 0.5), live.lost_s());
  figures.add("control period in real time: deviation, p99", percentile(deviation_ms, 0.99), "ms",
              config.jitter_bound_ms);
  figures.add("real-time square: not finished", result.completed ? 0.0 : 1.0, "", 0.0);
  return {{"pulses", begun_s.size()},
          {"cross_track_rms_mm", error_mm},
          {"deviation_median_ms", percentile(deviation_ms, 0.5)},
          {"deviation_p99_ms", percentile(deviation_ms, 0.99)},
          {"lost_real_time_s", live.lost_s()},
          {"stop_reason", result.stop_reason}};
}

void bench_hil(const CommonOptions& options) {
  auto config = resolve_config<HilConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  runs::RunFolder run({options.out, "bench hil", common::config_to_json(config), config.deployment.seed});
  run.begin();
  Figures figures;
  common::Json result = {{"machine", common::build_and_host_facts()}};
  result["round_trip"] = time_round_trips(config, figures);
  result["real_time"] = run_live(config, options.out, figures);
  result["square"] = compare_squares(config, figures);
  result["faults"] = run_fault_list(config, options.out, figures);
  result["long_run"] = run_hour(config, options.out, figures);
  result["figures"] = figures.take();
  common::write_file_atomically(options.out + "/hil.json", result.dump(1) + "\n");
  run.finish();
  if (!figures.broken().empty())
    throw common::HardwareError("bench hil: " + std::to_string(figures.broken().size()) +
                                " bounds are broken, the first: " + figures.broken().front());
}

}  // namespace

void add_bench_hil(CLI::App& bench, ConfigCatalogue& catalogue) {
  CLI::App* verb = bench.add_subcommand(
      "hil",
      "the real firmware on an emulated bench: faults, timing, errors; exit code 1 when a bound is broken");
  auto options = std::make_shared<CommonOptions>();
  catalogue["bench hil"] = [options] { return describe_resolved<HilConfig>(*options); };
  add_common_options(*verb, *options);
  add_virtual_rig_options(*verb, *options);
  add_shorthand(*verb, *options, "--policy", "policy", Shorthand::kText,
                "folder of the policy checkpoint; without it the proportional baseline drives");
  verb->callback([options] { bench_hil(*options); });
}

}  // namespace lodestone::apps
