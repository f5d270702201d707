#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lodestone/common/range.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/env/episode_batch.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/physics/plain_simulator.h"

namespace lodestone::env {

/// What domain randomisation draws anew in every episode, each uniformly over the range that is published for
/// it, as factors on the rig's description.
struct RandomisationConfig {
  bool enabled = false;
  common::Range moment = {0.95, 1.78};     // I: 1.6 to 3.0 mA m^2, 42 NdFeB magnets by remanence and size
  common::Range viscosity = {0.81, 1.05};  // Q: Cheng 2008, 30 to 20 C
  common::Range friction = {0.72, 1.8};    // Q: steel on plastic, 0.18 kinetic to 0.45 static

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("enabled", enabled, "", "draw the parameters below in every episode instead of the nominal ones");
    v.retired("moment_A_m2", "moment, a factor on the rig's");
    v.retired("viscosity_Pa_s", "viscosity, a factor on the rig's");
    v.retired("friction_coefficient", "friction, a factor on the rig's");
    v.field("moment", moment, "", "factor on the needle's magnetic moment", {0.0, 100.0});
    v.field("viscosity", viscosity, "", "factor on the fluid's viscosity", {0.0, 100.0});
    v.field("friction", friction, "", "factor on friction", {0.0, 100.0});
  }
};

/// The simulator of section IV-C as a training environment: the baseline of the paper's Table II.
struct PhysicsEnvConfig {
  physics::PlainSimulatorConfig simulator;
  RandomisationConfig randomise;
  double pulse_s = 0.1;  ///< section IV-B3
  double rest_s = 0.2;   ///< section IV-B3
  double pose_noise_m = 0.0;
  double heading_noise_rad = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("simulator", simulator, "point dipoles, Stokes drag, uniform friction");
    v.group("randomise", randomise, "domain randomisation: a stronger baseline than the paper's");
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
  /// Of the rig as it is described. threads: 0 means one per processor.
  PhysicsEnv(const EpisodeSettings& settings, const physics::RigDescription& rig,
             const PhysicsEnvConfig& config, std::int64_t threads);

  EnvSpec spec() const override { return episodes_.spec(); }
  const std::vector<float>& reset() override;
  const StepResult& step(const std::vector<float>& actions) override;
  Snapshot save() const override;
  void load(const Snapshot& snapshot) override;

 private:
  std::size_t shards() const;
  void begin(std::size_t i);
  void step_one(std::size_t i, const float* action);

  physics::RigDescription rig_;
  physics::CoilDrive drive_;
  PhysicsEnvConfig config_;
  /// One number for each of the randomised parameters.
  using Drawn = std::array<double, 3>;
  physics::PlainSimulator simulator_with(const Drawn& drawn) const;

  std::vector<Drawn> drawn_;                         // [N]
  std::vector<physics::PlainSimulator> simulators_;  // [N], or the only one
  EpisodeBatch episodes_;
  common::ThreadPool pool_;
};

}  // namespace lodestone::env
