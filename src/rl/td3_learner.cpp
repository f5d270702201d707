#include "lodestone/rl/td3_learner.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/tensor.h>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/rl/policy_evaluation.h"
#include "lodestone/runs/curves.h"

namespace lodestone::rl {
namespace {

std::int64_t buffer_capacity(const LearningConfig& learning, std::int64_t environments) {
  // the last step may exceed env_steps by a part of a batch
  return std::min(learning.buffer_size, learning.env_steps + environments);
}

at::Tensor rows_of(const std::vector<float>& numbers, std::int64_t columns) {
  return at::tensor(numbers).view({-1, columns});
}

void load_same_size(std::vector<float>& target, const nets::NamedTensors& stored, const char* name) {
  const auto found = stored.find(name);
  if (found == stored.end() || found->second.scalar_type() != at::kFloat ||
      static_cast<std::size_t>(found->second.numel()) != target.size()) {
    throw common::CheckpointError(std::string("training checkpoint: tensor \"") + name +
                                  "\" is missing or does not hold " + std::to_string(target.size()) +
                                  " numbers: resume with the configuration it was made with");
  }
  inference::check_finite(nets::to_array(found->second),
                          std::string("training checkpoint: tensor \"") + name + "\"");
  std::copy_n(found->second.data_ptr<float>(), target.size(), target.begin());
}

Td3Config as_here(Td3Config config) {
  const Td3Products asked = std::exchange(config.products, products_here(config.products));
  if (asked != config.products)
    common::log_warning(
        "td3.products = bfloat16: this processor has no products that are faster so; float32 it is");
  return config;
}

}  // namespace

Td3Learner::Td3Learner(const LearningConfig& learning, const Td3Config& td3, const NoiseConfig& noise,
                       std::uint64_t seed, std::int64_t threads, env::VecEnv& environments,
                       std::optional<Hindsight> hindsight)
    : learning_(learning),
      learning_rate_(td3.learning_rate),
      environments_(environments),
      td3_(make_td3(as_here(td3), environments.spec().observation_size, environments.spec().action_size, seed,
                    threads)),
      buffer_(buffer_capacity(learning, environments.spec().count), environments.spec().observation_size,
              environments.spec().action_size),
      noise_(noise, environments.spec().count, environments.spec().action_size, seed),
      hindsight_(std::move(hindsight)),
      overlap_(learning.overlap && threads > 1 ? 2 : 1) {
  observation_ = environments_.reset();
  returns_.resize(static_cast<std::size_t>(environments_.spec().count));
  lengths_.resize(returns_.size());
}

std::vector<float> Td3Learner::choose_actions() {
  if (env_steps_ < learning_.warm_up_steps) return noise_.uniform_actions();
  std::vector<float> action = td3_->act(observation_);
  const auto saturated =
      std::count_if(action.begin(), action.end(), [](float a) { return std::abs(a) > kSaturatedAction; });
  saturation_.add(static_cast<float>(saturated) / static_cast<float>(action.size()));
  const double done = static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps);
  const auto scale = static_cast<float>(1.0 - (1.0 - learning_.final_noise) * std::min(1.0, done));
  const std::vector<float> noise = noise_.next();
  for (std::size_t i = 0; i < action.size(); ++i)
    action[i] = std::clamp(std::fma(noise[i], scale, action[i]), -1.0F, 1.0F);
  return action;
}

void Td3Learner::step() {
  const at::NoGradGuard no_grad;
  const bool warming_up = env_steps_ < learning_.warm_up_steps;
  const std::vector<float> action = choose_actions();
  const env::StepResult* stepped = nullptr;
  if (learning_.overlap) {
    overlap_.for_each(2, [&](std::size_t part) {
      const at::NoGradGuard guard;  // thread-local
      if (part == 0) {
        make_due_updates();
      } else {
        stepped = &environments_.step(action);
      }
    });
  } else {
    stepped = &environments_.step(action);
  }
  const env::StepResult& result = *stepped;
  const std::vector<float>& done = result.action.empty() ? action : result.action;
  check_finite(result);
  buffer_.add(observation_, done, result);
  if (hindsight_) hindsight_->add(observation_, done, result, buffer_);
  count_episodes(result);
  observation_ = result.observation;
  env_steps_ += environments_.spec().count;
  if (warming_up) return;
  due_updates_ += learning_.updates_per_step * static_cast<double>(environments_.spec().count);
  if (!learning_.overlap) make_due_updates();
}

/// Nothing can be learned from what is not a number, and it would spread into every weight.
void Td3Learner::check_finite(const env::StepResult& result) const {
  const auto finite = [](float value) { return std::isfinite(value); };
  const auto check = [&](const std::vector<float>& values, const char* what) {
    const auto bad = std::find_if_not(values.begin(), values.end(), finite);
    if (bad == values.end()) return;
    const auto rows = static_cast<std::size_t>(environments_.spec().count);
    const std::size_t environment = static_cast<std::size_t>(bad - values.begin()) / (values.size() / rows);
    throw common::DataError("training the policy: " + std::string(what) + " of environment " +
                            std::to_string(environment) + " is " + std::to_string(*bad) + " after " +
                            std::to_string(env_steps_) +
                            " environment steps; the simulator left its range: check the dynamics with "
                            "`lodestone evaluate dynamics`");
  };
  check(result.reward, "the reward");
  check(result.final_observation, "the observation");
}

void Td3Learner::check_finite(const UpdateResult& update) const {
  if (std::isfinite(update.critic_loss) && std::isfinite(update.q_mean) &&
      (!update.policy_updated || std::isfinite(update.actor_loss)))
    return;
  throw common::Error("training the policy diverged at environment step " + std::to_string(env_steps_) +
                      ", update " + std::to_string(td3_->updates()) +
                      " (its loss is not finite); lower td3.learning_rate");
}

void Td3Learner::make_due_updates() {
  const double done = static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps);
  td3_->set_learning_rate(learning_rate_ *
                          (1.0 - (1.0 - learning_.final_learning_rate) * std::min(1.0, done)));
  for (; due_updates_ >= 1.0; due_updates_ -= 1.0) {
    const UpdateResult update = td3_->update(buffer_);
    check_finite(update);
    critic_loss_.add(update.critic_loss);
    q_.add(update.q_mean);
    if (update.policy_updated) actor_loss_.add(update.actor_loss);
  }
}

void Td3Learner::count_episodes(const env::StepResult& result) {
  for (std::size_t i = 0; i < returns_.size(); ++i) {
    returns_[i] += result.reward[i];
    lengths_[i] += 1.0F;
    if (result.terminated[i] == 0 && result.truncated[i] == 0) continue;
    noise_.episode_ended(i);
    return_.add(returns_[i]);
    length_.add(lengths_[i]);
    success_.add(result.success[i] != 0 ? 1.0 : 0.0);
    returns_[i] = 0.0F;
    lengths_[i] = 0.0F;
  }
}

common::Scalars Td3Learner::take_statistics() {
  common::Scalars scalars;
  const auto take = [&scalars](const char* key, Mean& mean) {
    if (mean.count > 0.0) scalars.emplace_back(key, mean.sum / mean.count);
    mean = Mean{};
  };
  take(runs::curves::kTrainReturn, return_);
  take(runs::curves::kTrainSuccess, success_);
  take(runs::curves::kTrainLength, length_);
  take(runs::curves::kCriticLoss, critic_loss_);
  take(runs::curves::kActorLoss, actor_loss_);
  take(runs::curves::kQ, q_);
  take(runs::curves::kTrainSaturation, saturation_);
  return scalars;
}

void Td3Learner::save(nets::Checkpoint& checkpoint) {
  td3_->save(checkpoint);
  checkpoint.parts["buffer"] = buffer_.save();
  const env::Snapshot snapshot = environments_.save();
  checkpoint.facts["environments"] = snapshot.facts;
  if (!snapshot.arrays.empty()) checkpoint.parts["environments"] = nets::to_tensors(snapshot.arrays);
  checkpoint.parts["running"] = {
      {"observation", rows_of(observation_, environments_.spec().observation_size)},
      {"returns", at::tensor(returns_)},
      {"lengths", at::tensor(lengths_)}};
  checkpoint.facts["noise"] = noise_.save();
  if (hindsight_) checkpoint.facts["hindsight"] = hindsight_->save();
  checkpoint.facts["env_steps"] = env_steps_;
  checkpoint.facts["due_updates"] = due_updates_;
}

void Td3Learner::load(const nets::Checkpoint& checkpoint) {
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
  load_same_size(observation_, running, "observation");
  load_same_size(returns_, running, "returns");
  load_same_size(lengths_, running, "lengths");
  env::Snapshot snapshot;
  snapshot.facts = checkpoint.facts["environments"];
  if (checkpoint.parts.count("environments") != 0)
    snapshot.arrays = nets::to_arrays(checkpoint.parts.at("environments"));
  environments_.load(snapshot);
  env_steps_ = checkpoint.facts["env_steps"].get<std::int64_t>();
  due_updates_ = checkpoint.facts["due_updates"].get<double>();
}

}  // namespace lodestone::rl
