#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/rig/rig_config.h"

namespace lodestone::experiments {

/// How a machine's speed is measured.
struct SpeedConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::int64_t runs = 5;
  double run_s = 1.0;
  std::int64_t td3_batch = 256;
  std::int64_t mbs_environments = 4096;
  std::int64_t images = 200;
  std::string segmenter;
  rig::RigConfig rig;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the inputs", {0, 9e15});
    v.field("threads", threads, "", "threads of the threaded figures; 0 means one per processor", {0, 1024});
    v.field("runs", runs, "", "rounds; every round measures every figure once, and medians are quoted",
            {1, 100});
    v.field("run_s", run_s, "s", "least time of one figure in one round", {0.01, 600.0});
    v.field("td3_batch", td3_batch, "transitions", "batch of one TD3 update", {2, 1 << 20});
    v.field("mbs_environments", mbs_environments, "", "environments stepped as one batch", {1, 1 << 22});
    v.field("images", images, "", "images per round from which the needle's pose is found", {10, 100000});
    v.field("segmenter", segmenter, "", "segmenter checkpoint; empty is the one that is shipped");
    v.group("rig", rig, "the rig that is simulated and seen");
  }
};

/// Rounds of one figure, in units per second.
struct Rate {
  double median = 0.0, least = 0.0, most = 0.0;
  /// Of what the BLAS' matrix product reached beside it: a machine whose pace changes changes both.
  std::optional<double> fraction_of_peak;
  std::optional<double> ns_per_step;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("median", median);
    v.field("min", least);
    v.field("max", most);
    v.field("fraction_of_peak", fraction_of_peak);
    v.field("ns_per_step", ns_per_step);
  }
};

/// A figure on all threads and on one.
struct ThreadedRate {
  Rate all_threads, one_thread;
  std::optional<double> flop;                 ///< of one unit of work
  std::optional<Rate> autograd_one_thread;    ///< TD3 as plain LibTorch would do it
  std::optional<std::map<int, Rate>> scales;  ///< all threads, by environments of one batch

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("all_threads", all_threads);
    v.field("one_thread", one_thread);
    v.field("flop", flop);
    v.field("autograd_one_thread", autograd_one_thread);
    v.field("by_environments", scales);
  }
};

/// Times from an image to what is known or done.
struct Latency {
  double median_ms = 0.0, p99_ms = 0.0, least_ms = 0.0, most_ms = 0.0;
  std::int64_t images = 0;  ///< or poses
  std::int64_t missed = 0;  ///< images without a pose; their time counts as well

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("median_ms", median_ms);
    v.field("p99_ms", p99_ms);
    v.field("min_ms", least_ms);
    v.field("max_ms", most_ms);
    v.field("images", images);
    v.field("missed", missed);
  }
};

/// `speed.json`.
struct SpeedResult {
  static constexpr const char* kFile = "speed.json";
  common::Json machine;
  std::string blas_core, kernels;
  std::int64_t threads = 0;
  common::Json config;
  std::string command;
  ThreadedRate sgemm;  ///< FLOP/s of 256 x 256 x 256 by the BLAS
  ThreadedRate gemm;   ///< the same by our own kernels, with packing, bias and ReLU
  ThreadedRate td3;    ///< updates/s
  ThreadedRate mbs;    ///< steps/s of all environments together
  ThreadedRate rig;    ///< control steps/s of virtual rigs
  Latency pose;        ///< image to pose, one thread
  Latency control;     ///< image to currents
  /// A pose to the next pulse, one thread: what the pulse before says about the rig, and planning, or the
  /// policy. Networks as in configs/best; absent in older results.
  std::optional<Latency> planner_decision, policy_decision;
  double training_peak_mb = 0.0;  ///< most memory held while training with a full buffer of a million

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("machine", machine);
    v.field("blas_core", blas_core);
    v.field("kernels", kernels);
    v.field("threads", threads);
    v.field("config", config);
    v.field("command", command);
    v.field("sgemm", sgemm);
    v.field("gemm", gemm);
    v.field("td3", td3);
    v.field("mbs", mbs);
    v.field("rig", rig);
    v.field("pose", pose);
    v.field("control", control);
    v.field("planner_decision", planner_decision);
    v.field("policy_decision", policy_decision);
    v.field("training_peak_mb", training_peak_mb);
  }
};

/// Measures this machine; `config` names a segmenter. Takes a gigabyte of memory. Throws Interrupted.
SpeedResult measure_speed(const SpeedConfig& config, const std::string& command);

/// Median and extremes of rounds; beside those of a peak, in units of `flop` each, the median fraction of it.
Rate rate_of(const std::vector<double>& rounds, double flop, const std::vector<double>& peak_rounds);

}  // namespace lodestone::experiments
