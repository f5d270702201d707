#include "lodestone/rl/policy_environments.h"

#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/env/physics_env.h"
#include "lodestone/nets/dynamics.h"

namespace lodestone::rl {

PolicyEnvironments make_policy_environments(TrainPolicyConfig& config) {
  std::optional<nets::DynamicsModel> model;
  if (!config.dynamics.empty()) {
    model = nets::load_dynamics(config.dynamics);
    config = adopt_data(std::move(config), model->info);
  } else if (config.simulator == "mbs") {
    throw common::ConfigError(
        "train-policy needs the learned simulator: --set dynamics=DIR (checkpoint of train-dynamics)");
  }
  const auto make = [&](std::int64_t count, const char* name,
                        std::int64_t threads) -> std::unique_ptr<env::VecEnv> {
    env::EpisodeSettings settings;
    settings.count = count;
    settings.task = config.task;
    settings.encoder = config.encoder;
    settings.action = config.action;
    settings.seed = common::derive_seed(static_cast<std::uint64_t>(config.seed), name);
    if (config.simulator == "mbs") {
      return std::make_unique<env::MbsEnv>(*model, settings, config.mbs, threads);
    }
    return std::make_unique<env::PhysicsEnv>(settings, config.physics, threads);
  };
  const std::int64_t beside_updates = config.training.learning.overlap ? 1 : config.threads;
  return {make(config.training.environments, "training", beside_updates),
          make(config.training.evaluation_episodes, "evaluation", config.threads)};
}

}  // namespace lodestone::rl
