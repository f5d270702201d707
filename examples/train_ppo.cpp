// PPO of your own (ppo.h) in 128 copies of a learned simulator. `lodestone deploy` drives what it learns.
//   build/examples/train_ppo configs/fast/policy_centre.json models/dynamics_best runs/ppo [UPDATES]
#include <cstdio>

#include "lodestone/inference/policy.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/rl/policy_environments.h"
#include "ppo.h"

using namespace lodestone;

int main(int count, char** words) try {
  if (count < 4) throw common::ConfigError("usage: train_ppo PRESET DYNAMICS POLICY [UPDATES]");
  auto config = common::config_from_json<rl::TrainPolicyConfig>(common::read_json_file(words[1]), words[1]);
  config.dynamics = words[2];
  config.training.environments = 128;
  const rl::PolicyEnvironments environments = rl::make_policy_environments(config);
  env::VecEnv& simulators = *environments.training;
  const auto rows_of = [](const auto& numbers) { return torch::tensor(numbers).view({128, -1}); };

  torch::manual_seed(1);
  torch::set_num_threads(1);  // sums then come out the same everywhere
  Ppo ppo(simulators.spec().observation_size);
  at::Tensor now = rows_of(simulators.reset());
  for (int update = 1; update <= (count > 4 ? std::atoi(words[4]) : 40); ++update) {
    std::vector<at::Tensor> seen, action, value, advantage, over, reached;
    for (int t = 0; t < 40; ++t) {
      const torch::NoGradGuard no_grad;
      seen.push_back(now);
      value.push_back(ppo.critic->forward(now));
      action.push_back(ppo.explore(now));
      const float* numbers = action.back().data_ptr<float>();
      const env::StepResult& step = simulators.step({numbers, numbers + action.back().numel()});
      // An episode that was cut would have gone on: it is worth what is expected after its last observation.
      const at::Tensor after = 0.97 * ppo.critic->forward(rows_of(step.final_observation));
      advantage.push_back(rows_of(step.reward) + (1 - rows_of(step.terminated)) * after - value.back());
      over.push_back(rows_of(step.terminated) | rows_of(step.truncated));
      reached.push_back(over.back() * rows_of(step.success));
      now = rows_of(step.observation);  // where an episode is over, of the next one
    }
    for (int t = 38; t >= 0; --t)  // generalised advantage estimation
      advantage[t] += 0.97 * 0.95 * (1 - over[t]) * advantage[t + 1];
    ppo.improve(torch::cat(seen), torch::cat(action), torch::cat(value), torch::cat(advantage));
    std::printf("update %d: %.1f %% reached the centre\n", update,
                100.0 * torch::cat(reached).sum().item<double>() / torch::cat(over).sum().item<double>());
  }
  inference::Policy policy;
  for (const auto& layer : ppo.actor->named_parameters())
    policy.weights[layer.key()] = nets::to_array(layer.value().detach());
  policy.hidden = {Ppo::kHidden, Ppo::kHidden};
  policy.encoder = config.encoder;
  policy.action = config.action;
  policy.goal = common::name_of(config.task.goal);
  policy.rig = config.learned_rig;
  inference::save_policy(words[3], policy, {}, {});
} catch (const common::Error& error) {
  std::fprintf(stderr, "train_ppo: %s\n", error.what());
  return 1;
}
