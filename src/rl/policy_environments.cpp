#include "lodestone/rl/policy_environments.h"

#include <optional>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/env/joined_env.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/env/physics_env.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/rl/model_gradient_learner.h"
#include "lodestone/rl/td3_learner.h"
#include "lodestone/rl/value_iteration_learner.h"

namespace lodestone::rl {

namespace {

/// Where the training data moved, as far as the task wants to know.
std::shared_ptr<const task::Region> region_for(const TrainPolicyConfig& config,
                                               const std::optional<inference::DynamicsModel>& model) {
  if (config.task.within != task::Within::kReachable) return nullptr;
  if (!model) throw common::ConfigError("task.within = \"reachable\" needs data to map: --set dynamics=DIR");
  return std::make_shared<const task::Region>(model->recorded_moves, config.region);
}

}  // namespace

PolicyEnvironments make_policy_environments(TrainPolicyConfig& config) {
  std::optional<inference::DynamicsModel> model;
  config = adopt_rig(std::move(config));
  if (!config.dynamics.empty()) {
    model = inference::load_dynamics(config.dynamics);
    config = adopt_data(std::move(config), model->info);
  } else if (config.simulator == Simulator::kMbs) {
    throw common::ConfigError(
        "train-policy needs the learned simulator: --set dynamics=DIR (checkpoint of train-dynamics)");
  }
  PolicyEnvironments made;
  made.region = region_for(config, model);
  made.dynamics = model;
  const auto settings_for = [&](std::int64_t count, const char* name) {
    env::EpisodeSettings settings;
    settings.count = count;
    settings.task = config.task;
    settings.encoder = config.encoder;
    settings.action = config.action;
    settings.seed = common::derive_seed(static_cast<std::uint64_t>(config.seed), name);
    settings.region = made.region;
    return settings;
  };
  const auto simulate = [&](const env::EpisodeSettings& settings,
                            std::int64_t threads) -> std::unique_ptr<env::VecEnv> {
    if (config.simulator == Simulator::kMbs)
      return std::make_unique<env::MbsEnv>(*model, settings, config.mbs, threads);
    return std::make_unique<env::PhysicsEnv>(settings, config.rig, config.physics, threads);
  };
  const PolicyTrainingConfig& training = config.training;
  const std::int64_t simulated = training.environments - config.replay.environments;
  std::vector<std::unique_ptr<env::VecEnv>> parts;
  const auto add = [&](std::unique_ptr<env::VecEnv> part) { parts.push_back(std::move(part)); };
  // Only while it learns does the success radius shrink; it is scored with the last one.
  const std::int64_t shrink_steps = training.learning.env_steps / training.environments;
  if (simulated > 0 && config.method == Method::kTd3) {
    env::EpisodeSettings settings = settings_for(simulated, "training");
    settings.shrink_steps = shrink_steps;
    add(simulate(settings, training.learning.overlap ? 1 : config.threads));
  }
  if (config.replay.environments > 0) {
    env::EpisodeSettings settings = settings_for(config.replay.environments, "replay");
    settings.shrink_steps = shrink_steps;
    add(std::make_unique<env::ReplayEnv>(data::read_recordings(config.recorded), settings, config.replay));
  }
  if (parts.size() == 1)
    made.training = std::move(parts.front());
  else if (!parts.empty())
    made.training = std::make_unique<env::JoinedEnv>(std::move(parts));
  made.evaluation = simulate(settings_for(training.evaluation_episodes, "evaluation"), config.threads);
  made.fresh = simulate(settings_for(training.evaluation_episodes, "fresh evaluation"), config.threads);
  return made;
}

std::unique_ptr<PolicyLearner> make_policy_learner(const TrainPolicyConfig& config,
                                                   const PolicyEnvironments& environments) {
  const LearningConfig& learning = config.training.learning;
  const auto seed = static_cast<std::uint64_t>(config.seed);
  if (config.method != Method::kTd3) {
    LODESTONE_CHECK(environments.dynamics, "dynamics to look into");
    if (config.method == Method::kModelGradient && config.action.size != 2)
      throw common::InvalidConfig("method", common::name_of(config.method),
                                  "be td3 or value_iteration where an action has " +
                                      std::to_string(config.action.size) +
                                      " numbers: this method proposes directions in the plane");
    const ImaginedTask task{config.task,
                            config.encoder,
                            config.action,
                            config.mbs.pose_noise_m,
                            config.mbs.heading_noise_rad,
                            config.training.environments,
                            environments.region};
    if (config.method == Method::kValueIteration)
      return std::make_unique<ValueIterationLearner>(learning, config.value_iteration, task,
                                                     *environments.dynamics, seed, config.threads);
    return std::make_unique<ModelGradientLearner>(learning, config.model_gradient, task,
                                                  *environments.dynamics, seed, config.threads);
  }
  std::optional<Hindsight> hindsight;
  if (learning.hindsight > 0.0)
    hindsight.emplace(learning.hindsight, config.task, config.encoder, config.training.environments, seed,
                      environments.region);
  return std::make_unique<Td3Learner>(learning, config.td3, config.noise, seed,
                                      common::thread_count(config.threads), *environments.training,
                                      std::move(hindsight));
}

runs::PolicyResult train_policy(const TrainPolicyConfig& config, const PolicyEnvironments& environments,
                                runs::RunFolder& run) {
  const std::unique_ptr<PolicyLearner> learner = make_policy_learner(config, environments);
  return train_policy(config, *learner, {*environments.evaluation, *environments.fresh}, run,
                      environments.region.get());
}

}  // namespace lodestone::rl
