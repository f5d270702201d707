#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/common/thread_pool.h"
#include "lodestone/env/episode_batch.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/physics/plain_simulator.h"

namespace lodestone::env {

/// The simulator of section IV-C as a training environment: the baseline of the paper's Table II.
struct PhysicsEnvConfig {
  physics::PlainSimulatorConfig simulator;
  double pulse_s = 0.1;  ///< section IV-B3
  double rest_s = 0.2;   ///< section IV-B3
  double pose_noise_m = 0.0;
  double heading_noise_rad = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("simulator", simulator, "point dipoles, Stokes drag, uniform friction");
    v.field("pulse_s", pulse_s, "s", "time the coils are on", {1e-3, 10.0});
    v.field("rest_s", rest_s, "s", "time after a pulse until the pose is taken", {0.0, 10.0});
    v.field("pose_noise_m", pose_noise_m, "m", "standard deviation of the sensed position, each axis",
            {0.0, 0.1});
    v.field("heading_noise_rad", heading_noise_rad, "rad", "standard deviation of the sensed heading",
            {0.0, 3.2});
  }
};

/// N copies of the plain simulator on threads. Episodes start anywhere within task.start_radius_m at any
/// heading; actions are currents in A.
class PhysicsEnv final : public VecEnv {
 public:
  /// threads: 0 means one per processor.
  PhysicsEnv(const EpisodeSettings& settings, const PhysicsEnvConfig& config, std::int64_t threads);

  EnvSpec spec() const override { return episodes_.spec(); }
  torch::Tensor reset() override;
  StepResult step(const torch::Tensor& actions) override;
  void exchange_state(EnvState& state, bool load) override { episodes_.exchange_state(state, load); }

 private:
  std::size_t shards() const;
  void begin(std::size_t i);
  void step_one(std::size_t i, const float* action);

  PhysicsEnvConfig config_;
  physics::PlainSimulator simulator_;
  EpisodeBatch episodes_;
  common::ThreadPool pool_;
};

}  // namespace lodestone::env
