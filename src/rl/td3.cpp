#include "lodestone/rl/td3.h"

#include <algorithm>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/rl/adam.h"

namespace lodestone::rl {
namespace {

constexpr std::size_t kShards = 2;

std::vector<std::int64_t> network_widths(std::int64_t in, const std::vector<std::int64_t>& hidden,
                                         std::int64_t out) {
  std::vector<std::int64_t> widths{in};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  widths.push_back(out);
  return widths;
}

FlatNetwork drawn_network(std::vector<std::int64_t> widths, torch::ScalarType type, std::uint64_t seed,
                          const char* name, std::uint64_t index) {
  FlatNetwork network(std::move(widths), type);
  common::RandomStream random(seed, name, index);
  network.initialise(random);
  return network;
}

void insert(nets::NamedTensors& all, const nets::NamedTensors& part) { all.insert(part.begin(), part.end()); }

void copy_named(const nets::NamedTensors& views, const nets::NamedTensors& stored, const char* part) {
  for (const auto& [name, view] : views) {
    const auto found = stored.find(name);
    if (found == stored.end() || found->second.sizes() != view.sizes() ||
        found->second.scalar_type() != view.scalar_type()) {
      throw common::CheckpointError(std::string("training checkpoint: tensor \"") + name + "\" of " + part +
                                    " is missing or of another shape than " + c10::str(view.sizes()) +
                                    ": resume with the configuration it was made with");
    }
    torch::Tensor target = view;
    target.copy_(found->second);
  }
}

}  // namespace

Td3::Learner::Learner(FlatNetwork drawn)
    : network(std::move(drawn)),
      target(network.clone()),
      first_moment(torch::zeros_like(network.parameters())),
      second_moment(torch::zeros_like(network.parameters())) {}

void Td3::Learner::adam(const torch::Tensor& gradient, double learning_rate) {
  ++steps;
  torch::Tensor& p = network.parameters();
  const auto count = static_cast<std::size_t>(p.numel());
  AT_DISPATCH_FLOATING_TYPES(p.scalar_type(), "adam", [&] {
    adam_step(p.data_ptr<scalar_t>(), gradient.data_ptr<scalar_t>(), first_moment.data_ptr<scalar_t>(),
              second_moment.data_ptr<scalar_t>(), count, learning_rate, steps);
  });
}

void Td3::Learner::polyak(double tau) {
  torch::Tensor& p = network.parameters();
  AT_DISPATCH_FLOATING_TYPES(p.scalar_type(), "polyak", [&] {
    polyak_step(target.parameters().data_ptr<scalar_t>(), p.data_ptr<scalar_t>(),
                static_cast<std::size_t>(p.numel()), tau);
  });
}

Td3::Td3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size, std::uint64_t seed,
         std::int64_t threads, torch::ScalarType type)
    : config_(config),
      observation_size_(observation_size),
      action_size_(action_size),
      learning_rate_(config.learning_rate),
      random_(seed, "td3"),
      threads_(static_cast<std::size_t>(std::clamp<std::int64_t>(threads, 1, kShards))),
      actor_(drawn_network(network_widths(observation_size, config.hidden, action_size), type, seed, "actor",
                           0)),
      critics_{Learner(drawn_network(network_widths(observation_size + action_size, config.hidden, 1), type,
                                     seed, "critic", 0)),
               Learner(drawn_network(network_widths(observation_size + action_size, config.hidden, 1), type,
                                     seed, "critic", 1))},
      batch_(config.batch_size, observation_size, action_size, type) {
  LODESTONE_CHECK(config.batch_size >= 2, "TD3 needs a batch of at least 2");
  const std::int64_t rows = config.batch_size;
  noise_ = torch::zeros({rows, action_size}, type);
  critic_input_ = torch::zeros({rows, observation_size + action_size}, type);
  next_input_ = torch::zeros_like(critic_input_);
  target_q_ = torch::zeros({rows}, type);
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    critic_work_[k] = critics_[k].network.workspace(rows);
    target_work_[k] = critics_[k].target.workspace(rows);
    q_gradient_[k] = torch::zeros({rows, 1}, type);
  }
  const std::int64_t middle = rows / 2;
  for (const auto& [start, count] : {std::pair(std::int64_t{0}, middle), std::pair(middle, rows - middle)}) {
    halves_.push_back({start, count, actor_.network.workspace(count), critics_[0].network.workspace(count),
                       torch::zeros({count, action_size}, type),
                       torch::zeros({count, observation_size + action_size}, type),
                       torch::zeros({count, action_size}, type)});
  }
}

torch::Tensor Td3::act(const torch::Tensor& observation) {
  const torch::NoGradGuard no_grad;
  LODESTONE_CHECK(observation.dim() == 2 && observation.size(1) == observation_size_ &&
                      observation.scalar_type() == actor_.network.parameters().scalar_type(),
                  "TD3 policy: observation is " + c10::str(observation.sizes()) + ", expected [N, " +
                      std::to_string(observation_size_) + "]");
  if (!act_work_.output.defined() || act_work_.output.size(0) != observation.size(0)) {
    act_work_ = actor_.network.workspace(observation.size(0));
  }
  return actor_.network.forward(observation, act_work_).tanh();
}

UpdateResult Td3::update(const ReplayBuffer& buffer) {
  buffer.sample(random_, batch_);
  float* noise = noise_.data_ptr<float>();
  for (std::int64_t i = 0; i < noise_.numel(); ++i) {
    noise[i] = static_cast<float>(config_.policy_noise * random_.normal());
  }
  return update(batch_, noise_);
}

void Td3::check_batch(const Batch& batch, const torch::Tensor& noise) const {
  const auto type = actor_.network.parameters().scalar_type();
  const std::int64_t rows = config_.batch_size;
  const auto check = [&](const torch::Tensor& tensor, torch::IntArrayRef shape, const char* name) {
    LODESTONE_CHECK(tensor.sizes() == shape && tensor.scalar_type() == type,
                    std::string("TD3 update: ") + name + " is " +
                        c10::str(tensor.sizes(), " ", tensor.dtype()) + ", expected " +
                        c10::str(shape, " ", type));
  };
  check(batch.observation, {rows, observation_size_}, "observation");
  check(batch.action, {rows, action_size_}, "action");
  check(batch.reward, {rows}, "reward");
  check(batch.next_observation, {rows, observation_size_}, "next observation");
  check(batch.not_done, {rows}, "not_done");
  check(noise, {rows, action_size_}, "smoothing noise");
}

void Td3::smoothed_target_actions(const Batch& batch, const torch::Tensor& noise, Half& half) {
  const torch::Tensor next = batch.next_observation.narrow(0, half.start, half.rows);
  torch::Tensor rows = next_input_.narrow(0, half.start, half.rows);
  rows.narrow(1, 0, observation_size_).copy_(next);
  at::tanh_out(half.policy, actor_.target.forward(next, half.actor));
  half.policy.add_(noise.narrow(0, half.start, half.rows).clamp(-config_.noise_clip, config_.noise_clip));
  rows.narrow(1, observation_size_, action_size_).copy_(half.policy.clamp_(-1.0, 1.0));
  torch::Tensor now = critic_input_.narrow(0, half.start, half.rows);
  now.narrow(1, 0, observation_size_).copy_(batch.observation.narrow(0, half.start, half.rows));
  now.narrow(1, observation_size_, action_size_).copy_(batch.action.narrow(0, half.start, half.rows));
}

UpdateResult Td3::update(const Batch& batch, const torch::Tensor& smoothing_noise) {
  check_batch(batch, smoothing_noise);
  const torch::NoGradGuard no_grad;
  ++updates_;
  UpdateResult result;
  result.policy_updated = updates_ % config_.policy_frequency == 0;
  threads_.for_each(kShards, [&](std::size_t shard) {
    const torch::NoGradGuard guard;  // thread-local
    smoothed_target_actions(batch, smoothing_noise, halves_[shard]);
  });
  threads_.for_each(kShards, [&](std::size_t k) {
    const torch::NoGradGuard guard;
    critics_[k].target.forward(next_input_, target_work_[k]);
    critics_[k].network.forward(critic_input_, critic_work_[k]);
  });
  at::minimum_out(target_q_, target_work_[0].output.squeeze(1), target_work_[1].output.squeeze(1));
  target_q_.mul_(batch.not_done).mul_(config_.discount).add_(batch.reward);
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    at::sub_out(q_gradient_[k], critic_work_[k].output, target_q_.unsqueeze(1));
    result.critic_loss += q_gradient_[k].square().mean().item<double>();
    q_gradient_[k].mul_(2.0 / static_cast<double>(config_.batch_size));
  }
  result.q_mean = critic_work_[0].output.mean().item<double>();
  result.target_q = target_q_;
  threads_.for_each(kShards, [&](std::size_t k) {
    const torch::NoGradGuard guard;
    critics_[k].network.backward(critic_input_, q_gradient_[k], critic_work_[k],
                                 FlatNetwork::Wanted::kParameters);
    critics_[k].adam(critic_work_[k].gradient, learning_rate_);
    if (result.policy_updated) critics_[k].polyak(config_.polyak_tau);  // the policy's update reads no target
  });
  if (result.policy_updated) result.actor_loss = update_policy(batch);
  return result;
}

double Td3::update_policy(const Batch& batch) {
  threads_.for_each(kShards, [&](std::size_t shard) {
    const torch::NoGradGuard guard;
    Half& half = halves_[shard];
    const torch::Tensor observation = batch.observation.narrow(0, half.start, half.rows);
    at::tanh_out(half.policy, actor_.network.forward(observation, half.actor));
    half.critic_input.narrow(1, 0, observation_size_).copy_(observation);
    half.critic_input.narrow(1, observation_size_, action_size_).copy_(half.policy);
    critics_[0].network.forward(half.critic_input, half.critic);
    const torch::Tensor q_gradient = torch::full(
        {half.rows, 1}, -1.0 / static_cast<double>(config_.batch_size), half.policy.scalar_type());
    critics_[0].network.backward(half.critic_input, q_gradient, half.critic, FlatNetwork::Wanted::kInput);
    at::tanh_backward_out(half.policy_gradient,
                          half.critic.input_gradient.narrow(1, observation_size_, action_size_), half.policy);
    actor_.network.backward(observation, half.policy_gradient, half.actor, FlatNetwork::Wanted::kParameters);
  });
  double q_sum = 0.0;
  for (Half& half : halves_) q_sum += half.critic.output.sum().item<double>();
  halves_[0].actor.gradient.add_(halves_[1].actor.gradient);
  actor_.adam(halves_[0].actor.gradient, learning_rate_);
  actor_.polyak(config_.polyak_tau);
  return -q_sum / static_cast<double>(config_.batch_size);
}

nets::NamedTensors Td3::networks() const {
  nets::NamedTensors all;
  insert(all, actor_.network.named(actor_.network.parameters(), "actor."));
  insert(all, actor_.target.named(actor_.target.parameters(), "actor_target."));
  const int layers = static_cast<int>(config_.hidden.size()) + 1;
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    const int first = 1 + static_cast<int>(k) * layers;
    insert(all, critics_[k].network.named(critics_[k].network.parameters(), "critic.", first));
    insert(all, critics_[k].target.named(critics_[k].target.parameters(), "critic_target.", first));
  }
  return all;
}

nets::NamedTensors Td3::actor() const { return actor_.network.named(actor_.network.parameters(), ""); }

nets::NamedTensors Td3::optimiser() const {
  nets::NamedTensors all;
  insert(all, actor_.network.named(actor_.first_moment, "actor.first_moment."));
  insert(all, actor_.network.named(actor_.second_moment, "actor.second_moment."));
  const int layers = static_cast<int>(config_.hidden.size()) + 1;
  for (std::size_t k = 0; k < critics_.size(); ++k) {
    const int first = 1 + static_cast<int>(k) * layers;
    insert(all, critics_[k].network.named(critics_[k].first_moment, "critic.first_moment.", first));
    insert(all, critics_[k].network.named(critics_[k].second_moment, "critic.second_moment.", first));
  }
  return all;
}

void Td3::save(nets::Checkpoint& checkpoint) const {
  for (const auto& [name, tensor] : networks()) checkpoint.parts["networks"][name] = tensor.clone();
  for (const auto& [name, tensor] : optimiser()) checkpoint.parts["optimiser"][name] = tensor.clone();
  checkpoint.facts["td3"] = {{"updates", updates_},
                             {"actor_steps", actor_.steps},
                             {"critic_steps", critics_[0].steps},
                             {"random", random_.save()}};
}

void Td3::load(const nets::Checkpoint& checkpoint) {
  const auto networks_part = checkpoint.parts.find("networks");
  const auto optimiser_part = checkpoint.parts.find("optimiser");
  if (networks_part == checkpoint.parts.end() || optimiser_part == checkpoint.parts.end() ||
      !checkpoint.facts.contains("td3")) {
    throw common::CheckpointError("training checkpoint: networks, optimiser or td3 counters are missing");
  }
  copy_named(networks(), networks_part->second, "networks");
  copy_named(optimiser(), optimiser_part->second, "optimiser");
  const common::Json& facts = checkpoint.facts["td3"];
  try {
    updates_ = facts.at("updates").get<std::int64_t>();
    actor_.steps = facts.at("actor_steps").get<std::int64_t>();
    for (Learner& critic : critics_) critic.steps = facts.at("critic_steps").get<std::int64_t>();
    random_.restore(facts.at("random").get<std::string>());
  } catch (const nlohmann::json::exception& error) {
    throw common::CheckpointError(std::string("training checkpoint: td3 counters are malformed: ") +
                                  error.what());
  }
}

}  // namespace lodestone::rl
