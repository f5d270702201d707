#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "lodestone/experiments/speed.h"
#include "lodestone/rl/td3_config.h"

namespace lodestone::experiments {

/// One thing that is measured: calling it measures for one round and returns the rate in units per second.
using RateFigure = std::function<double()>;

/// Matrix products of 256 x 256 x 256 by the machine's BLAS on `threads` threads at once, in FLOP/s.
RateFigure sgemm_rate(const SpeedConfig& config, std::int64_t threads);
/// The same product by our own kernels, with packing of the right-hand side, bias and ReLU included.
RateFigure gemm_rate(const SpeedConfig& config, std::int64_t threads);
/// Updates/s of TD3 with the paper's networks, on one batch.
RateFigure td3_rate(const SpeedConfig& config, const rl::Td3Config& td3, std::int64_t threads);
/// Steps/s of all environments together of an MBS with the paper's network as drawn: the time does not depend
/// on what was learned.
RateFigure mbs_rate(const SpeedConfig& config, std::int64_t environments, std::int64_t threads);
/// Control steps/s of virtual rigs, each 100 ms of pulse and 200 ms of rest with random currents.
RateFigure rig_rate(const SpeedConfig& config, std::int64_t threads);

/// FLOP of the matrix products of one TD3 update, and of one step of one MBS environment.
double td3_update_flop(const rl::Td3Config& td3);
double mbs_step_flop();

/// From a camera's image to what is known or done, for a needle that moves as a driven one does.
class ImageLatency {
 public:
  explicit ImageLatency(const SpeedConfig& config);
  ~ImageLatency();
  /// Another config.images images.
  void measure();
  std::vector<double> pose_ms;     ///< image -> pose, one thread
  std::vector<double> command_ms;  ///< image -> pose -> policy -> currents
  std::int64_t missed = 0;         ///< images without a pose; their time counts as well

 private:
  struct Bench;
  SpeedConfig config_;
  std::unique_ptr<Bench> bench_;
};

/// From a pose to the next pulse, one thread, identification included.
class DecisionLatency {
 public:
  explicit DecisionLatency(const SpeedConfig& config);
  ~DecisionLatency();
  /// Another config.images poses.
  void measure();
  std::vector<double> planner_ms, policy_ms;

 private:
  struct Deciders;
  SpeedConfig config_;
  std::unique_ptr<Deciders> deciders_;
};

/// Trains for a moment with the paper's networks and a replay buffer of a million transitions, filled;
/// returns the most memory the program has held so far, in MB. Call before anything else that needs memory.
double training_memory_mb(const SpeedConfig& config, std::int64_t threads);

}  // namespace lodestone::experiments
