#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/bounded_figure.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/fault_injection.h"
#include "lodestone/experiments/period_deviation.h"

namespace lodestone::experiments {

/// What `bench emulation` measures, and what it must keep to.
struct EmulationBenchConfig {
  DeploymentConfig deployment;
  std::int64_t threads = 0;
  std::string policy;
  std::string dynamics;
  McapConfig mcap;
  std::int64_t pulses = 12000;
  std::int64_t round_trips = 500;
  std::int64_t timed_squares = 3;
  double round_trip_bound_ms = 5.0;
  double jitter_bound_ms = 5.0;
  double error_bound = 0.1;

  EmulationBenchConfig() {
    deployment.trials.count = 20;
    deployment.loop.rest_s = 0.2333;  // a period of a third of a second
    deployment.loop.decide_s = 0.12;
  }
  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("policy", policy, "",
            "folder of the policy checkpoint; empty: the planner drives, or without `dynamics` the "
            "proportional baseline");
    v.field(
        "dynamics", dynamics, "",
        "folder of the dynamics checkpoint that the planner plans in, and that the bench is identified by");
    v.group("mcap", mcap, "logs of the squares");
    v.field("pulses", pulses, "",
            "pulses of the run with a random fault a minute; 12000 take an hour of bench time", {0, 1e6});
    v.field("round_trips", round_trips, "", "answers of the firmware to time", {10, 100000});
    v.field("timed_squares", timed_squares, "",
            "squares in real time, alone and as many with every processor busy, to time the control period; "
            "about "
            "130 pulses each",
            {1, 1000});
    v.field("round_trip_bound_ms", round_trip_bound_ms, "ms", "median of the way there and back",
            {0.1, 1000.0});
    v.field("jitter_bound_ms", jitter_bound_ms, "ms", "99th percentile of the period's deviation",
            {0.1, 1000.0});
    v.field("error_bound", error_bound, "",
            "largest relative difference from the simulated coils' mean error", {0.0, 10.0});
  }
  void validate() const { deployment.rig.validate(); }
};

/// Times of the firmware's answers.
struct RoundTrips {
  double ping_median_ms = 0.0, ping_p99_ms = 0.0;
  double status_median_ms = 0.0, status_p99_ms = 0.0;  ///< with the whole status
  double lost_real_time_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("ping_median_ms", ping_median_ms);
    v.field("ping_p99_ms", ping_p99_ms);
    v.field("status_median_ms", status_median_ms);
    v.field("status_p99_ms", status_p99_ms);
    v.field("lost_real_time_s", lost_real_time_s);
  }
};

/// Squares in real time: pseudo-terminal, GigE Vision camera, U-Net, controller.
struct RealTimeSquares : PeriodDeviation {
  std::int64_t squares = 0, pulses = 0;
  double cross_track_rms_mm = 0.0;  ///< mean of the squares
  double lost_real_time_s = 0.0;
  std::string stop_reason;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("squares", squares);
    v.field("pulses", pulses);
    v.field("cross_track_rms_mm", cross_track_rms_mm);
    PeriodDeviation::visit(v);
    v.field("lost_real_time_s", lost_real_time_s);
    v.field("stop_reason", stop_reason);
  }
};

/// Mean cross-track RMS of the same squares through the simulated coils and through the firmware.
struct SquareComparison {
  double simulated_mm = 0.0, emulated_mm = 0.0;
  std::int64_t trials = 0;
  /// Simulated coils whose drivers follow at once, where the rig's do not (rig.amplifier).
  std::optional<double> ideal_mm;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("simulated_mm", simulated_mm);
    v.field("emulated_mm", emulated_mm);
    v.field("trials", trials);
    v.field("ideal_mm", ideal_mm);
  }
};

/// `emulation.json`. A part that was not measured is absent.
struct EmulationResult {
  static constexpr const char* kFile = "emulation.json";
  common::Json machine;
  std::optional<RoundTrips> round_trip;
  std::optional<RealTimeSquares> real_time;
  std::optional<RealTimeSquares> under_load;  ///< the same while every processor is busy
  std::optional<SquareComparison> square;
  std::vector<FaultResult> faults;
  std::optional<HourReport> long_run;
  std::vector<BoundedFigure> figures;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("machine", machine);
    v.field("round_trip", round_trip);
    v.field("real_time", real_time);
    v.field("under_load", under_load);
    v.field("square", square);
    v.field("faults", faults);
    v.field("long_run", long_run);
    v.field("figures", figures);
  }
};

/// The real firmware on an emulated bench, measured part by part. Each adds what it found, and its bounded
/// figures, to the result. They throw HardwareError where there is no emulator, and Interrupted.
class EmulationBench {
 public:
  /// Reads what drives: throws as load_simulator and policy_source. `folder` takes what the runs record, and
  /// exists before the first part is measured. `config` must outlive the bench.
  EmulationBench(const EmulationBenchConfig& config, std::string folder);

  void time_round_trips();
  /// Alone, and then with every processor busy.
  void drive_in_real_time();
  void compare_squares();
  void inject_every_fault();
  /// Nothing where config.pulses is 0.
  void inject_for_long();
  const EmulationResult& result() const { return result_; }

 private:
  void add(const std::string& figure, double value, const char* unit, double bound);
  /// What is logged of trials, in a folder of this name; nothing where no logs are asked for.
  TrialFolders folders(const std::string& name) const;
  RealTimeSquares drive_squares(const std::string& how, const TrialFolders& folders);
  /// Adds one to `squares`; returns by how much each of its pulses came too early or too late.
  std::vector<double> drive_square(std::int64_t index, const std::string& how, const TrialFolders& folders,
                                   RealTimeSquares& squares);

  const EmulationBenchConfig& config_;
  std::string folder_;
  std::uint64_t seed_;
  ControllerSource source_;
  EmulationResult result_;
};

}  // namespace lodestone::experiments
