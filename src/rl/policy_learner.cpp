#include "lodestone/rl/policy_learner.h"

#include <algorithm>
#include <string>

#include "lodestone/common/error.h"

namespace lodestone::rl {
namespace {

constexpr float kSaturated = 0.95F;  // an action component beyond this counts as saturated

std::int64_t buffer_capacity(const LearningConfig& learning, std::int64_t environments) {
  // the last step may exceed env_steps by a part of a batch
  return std::min(learning.buffer_size, learning.env_steps + environments);
}

void load_same_shape(torch::Tensor& target, const nets::NamedTensors& stored, const char* name) {
  const auto found = stored.find(name);
  if (found == stored.end() || found->second.sizes() != target.sizes() ||
      found->second.scalar_type() != target.scalar_type()) {
    throw common::CheckpointError(std::string("training checkpoint: tensor \"") + name +
                                  "\" is missing or not of shape " + c10::str(target.sizes()) +
                                  ": resume with the configuration it was made with");
  }
  target.copy_(found->second);
}

}  // namespace

PolicyLearner::PolicyLearner(const LearningConfig& learning, const Td3Config& td3, const NoiseConfig& noise,
                             std::uint64_t seed, std::int64_t threads, env::VecEnv& environments,
                             std::optional<Hindsight> hindsight)
    : learning_(learning),
      learning_rate_(td3.learning_rate),
      environments_(environments),
      td3_(make_td3(td3, environments.spec().observation_size, environments.spec().action_size, seed,
                    threads)),
      buffer_(buffer_capacity(learning, environments.spec().count), environments.spec().observation_size,
              environments.spec().action_size),
      noise_(noise, environments.spec().count, environments.spec().action_size, seed),
      hindsight_(std::move(hindsight)),
      overlap_(learning.overlap && threads > 1 ? 2 : 1) {
  observation_ = environments_.reset().clone();
  returns_ = torch::zeros({environments_.spec().count}, torch::kFloat32);
  lengths_ = torch::zeros({environments_.spec().count}, torch::kFloat32);
}

torch::Tensor PolicyLearner::choose_actions() {
  if (env_steps_ < learning_.warm_up_steps) return noise_.uniform_actions();
  torch::Tensor action = td3_->act(observation_);
  saturation_.add((action.abs() > kSaturated).to(torch::kFloat32).mean().item<double>());
  const double done = static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps);
  const double scale = 1.0 - (1.0 - learning_.final_noise) * std::min(1.0, done);
  return action.add_(noise_.next(), scale).clamp_(-1.0, 1.0);
}

void PolicyLearner::step() {
  const torch::NoGradGuard no_grad;
  const bool warming_up = env_steps_ < learning_.warm_up_steps;
  const torch::Tensor action = choose_actions();
  env::StepResult result;
  if (learning_.overlap) {
    overlap_.for_each(2, [&](std::size_t part) {
      const torch::NoGradGuard guard;  // thread-local
      if (part == 0) {
        make_due_updates();
      } else {
        result = environments_.step(action);
      }
    });
  } else {
    result = environments_.step(action);
  }
  const torch::Tensor& done = result.action.defined() ? result.action : action;
  buffer_.add(observation_, done, result);
  if (hindsight_) hindsight_->add(observation_, done, result, buffer_);
  noise_.episodes_ended(result.terminated.bitwise_or(result.truncated));
  count_episodes(result);
  observation_.copy_(result.observation);
  env_steps_ += environments_.spec().count;
  if (warming_up) return;
  due_updates_ += learning_.updates_per_step * static_cast<double>(environments_.spec().count);
  if (!learning_.overlap) make_due_updates();
}

void PolicyLearner::make_due_updates() {
  const double done = static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps);
  td3_->set_learning_rate(learning_rate_ *
                          (1.0 - (1.0 - learning_.final_learning_rate) * std::min(1.0, done)));
  for (; due_updates_ >= 1.0; due_updates_ -= 1.0) {
    const UpdateResult update = td3_->update(buffer_);
    critic_loss_.add(update.critic_loss);
    q_.add(update.q_mean);
    if (update.policy_updated) actor_loss_.add(update.actor_loss);
  }
}

void PolicyLearner::count_episodes(const env::StepResult& result) {
  returns_.add_(result.reward);
  lengths_.add_(1.0);
  const auto* terminated = result.terminated.data_ptr<std::uint8_t>();
  const auto* truncated = result.truncated.data_ptr<std::uint8_t>();
  const auto* success = result.success.data_ptr<std::uint8_t>();
  float* returns = returns_.data_ptr<float>();
  float* lengths = lengths_.data_ptr<float>();
  for (std::int64_t i = 0; i < returns_.numel(); ++i) {
    if (terminated[i] == 0 && truncated[i] == 0) continue;
    return_.add(returns[i]);
    length_.add(lengths[i]);
    success_.add(success[i] != 0 ? 1.0 : 0.0);
    returns[i] = 0.0F;
    lengths[i] = 0.0F;
  }
}

common::Scalars PolicyLearner::take_statistics() {
  common::Scalars scalars;
  const auto take = [&scalars](const char* key, Mean& mean) {
    if (mean.count > 0.0) scalars.emplace_back(key, mean.sum / mean.count);
    mean = Mean{};
  };
  take("train/episode_return", return_);
  take("train/success_rate", success_);
  take("train/episode_length", length_);
  take("train/critic_loss", critic_loss_);
  take("train/actor_loss", actor_loss_);
  take("train/q_mean", q_);
  take("train/action_saturation", saturation_);
  return scalars;
}

void PolicyLearner::save(nets::Checkpoint& checkpoint) {
  td3_->save(checkpoint);
  checkpoint.parts["buffer"] = buffer_.save();
  env::EnvState state;
  environments_.exchange_state(state, false);
  checkpoint.facts["environments"] = state.facts;
  for (const auto& [name, tensor] : state.tensors) checkpoint.parts["environments"][name] = tensor.clone();
  checkpoint.parts["running"] = {
      {"observation", observation_.clone()}, {"returns", returns_.clone()}, {"lengths", lengths_.clone()}};
  checkpoint.facts["noise"] = noise_.save();
  if (hindsight_) checkpoint.facts["hindsight"] = hindsight_->save();
  checkpoint.facts["env_steps"] = env_steps_;
  checkpoint.facts["due_updates"] = due_updates_;
}

void PolicyLearner::load(const nets::Checkpoint& checkpoint) {
  for (const char* part : {"buffer", "running"}) {
    if (checkpoint.parts.count(part) == 0) {
      throw common::CheckpointError(std::string("training checkpoint: part \"") + part + "\" is missing");
    }
  }
  for (const char* fact : {"environments", "noise", "env_steps", "due_updates"}) {
    if (!checkpoint.facts.contains(fact)) {
      throw common::CheckpointError(std::string("training checkpoint: fact \"") + fact + "\" is missing");
    }
  }
  td3_->load(checkpoint);
  buffer_.load(checkpoint.parts.at("buffer"));
  noise_.load(checkpoint.facts["noise"]);
  if (hindsight_) hindsight_->load(checkpoint.facts.value("hindsight", common::Json()));
  const nets::NamedTensors& running = checkpoint.parts.at("running");
  load_same_shape(observation_, running, "observation");
  load_same_shape(returns_, running, "returns");
  load_same_shape(lengths_, running, "lengths");
  env::EnvState state;
  state.facts = checkpoint.facts["environments"];
  if (checkpoint.parts.count("environments") != 0) state.tensors = checkpoint.parts.at("environments");
  environments_.exchange_state(state, true);
  env_steps_ = checkpoint.facts["env_steps"].get<std::int64_t>();
  due_updates_ = checkpoint.facts["due_updates"].get<double>();
}

}  // namespace lodestone::rl
