#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/common/random.h"

namespace lodestone::rl {

/// Ornstein-Uhlenbeck (the paper's) is correlated in time; the Gaussian one is independent from step to step.
enum class NoiseKind { kOrnsteinUhlenbeck, kGaussian };
inline std::vector<std::string> names_of(NoiseKind) { return {"ou", "gaussian"}; }

/// Exploration noise added to the policy's actions in training.
struct NoiseConfig {
  NoiseKind kind = NoiseKind::kOrnsteinUhlenbeck;
  double theta = 0.15;  ///< pull towards zero
  double sigma = 0.2;   ///< action units
  double dt = 1.0;      ///< steps of the process per control step
  bool reset_with_episode = true;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("kind", kind, "", "Ornstein-Uhlenbeck (correlated in time) or independent normal noise");
    v.field("theta", theta, "1/step", "pull of the Ornstein-Uhlenbeck process towards zero", {0.0, 10.0});
    v.field("sigma", sigma, "action units",
            "standard deviation of one step's increment, or of the normal noise", {0.0, 10.0});
    v.field("dt", dt, "steps", "time step of the Ornstein-Uhlenbeck process", {1e-6, 10.0});
    v.field("reset_with_episode", reset_with_episode, "",
            "the process starts again from zero with every episode");
  }
};

/// One process per environment, each with a random stream of its own, so that the noise of an environment
/// does not depend on how many there are: x += -theta x dt + sigma sqrt(dt) n (Uhlenbeck and Ornstein, Phys.
/// Rev. 36, 823, 1930).
class ExplorationNoise {
 public:
  ExplorationNoise(const NoiseConfig& config, std::int64_t environments, std::int64_t action_size,
                   std::uint64_t seed);

  /// Next noise [N, A].
  std::vector<float> next();
  /// Uniform actions in [-1, 1] from the same streams, for the warm-up [N, A].
  std::vector<float> uniform_actions();
  /// The episode of an environment ended.
  void episode_ended(std::size_t environment);

  common::Json save() const;
  /// Throws CheckpointError when it does not fit.
  void load(const common::Json& state);

 private:
  double keep_;  // part of the state that stays from step to step
  double step_;  // standard deviation of what is added
  bool reset_with_episode_;
  std::size_t action_size_;
  std::vector<common::RandomStream> streams_;
  std::vector<double> state_;  // [N * A]
};

}  // namespace lodestone::rl
