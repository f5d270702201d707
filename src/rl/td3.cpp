#include "lodestone/rl/td3.h"

#include <string>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/from_blob.h>
#include <ATen/ops/zeros.h>
#include <c10/util/StringUtil.h>

#include "lodestone/common/error.h"
#include "lodestone/inference/gemm_bf16.h"
#include "td3_autograd.h"
#include "td3_fused.h"

namespace lodestone::rl {
namespace {

constexpr const char* kActorPrefix = "actor.";

void copy_named(const nets::NamedTensors& views, const nets::NamedTensors& stored, const char* part) {
  const at::NoGradGuard no_grad;
  for (const auto& [name, view] : views) {
    const auto found = stored.find(name);
    if (found == stored.end() || found->second.sizes() != view.sizes() ||
        found->second.scalar_type() != view.scalar_type()) {
      throw common::CheckpointError(std::string("training checkpoint: tensor \"") + name + "\" of " + part +
                                    " is missing or of another shape than " + c10::str(view.sizes()) +
                                    ": resume with the configuration it was made with");
    }
    inference::check_finite(nets::to_array(found->second),
                            std::string("training checkpoint: tensor \"") + name + "\"");
    at::Tensor target = view;
    target.copy_(found->second);
  }
}

}  // namespace

Td3::Td3(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size, std::uint64_t seed,
         at::ScalarType type)
    : config_(config),
      observation_size_(observation_size),
      action_size_(action_size),
      type_(type),
      learning_rate_(config.learning_rate),
      random_(seed, "td3"),
      batch_(config.batch_size, observation_size, action_size, type),
      noise_(at::zeros({config.batch_size, action_size}, type)) {
  LODESTONE_CHECK(config.batch_size >= 2, "TD3 needs a batch of at least 2");
}

std::vector<float> Td3::act(const std::vector<float>& observation) {
  const at::NoGradGuard no_grad;
  const auto rows = static_cast<std::int64_t>(observation.size()) / observation_size_;
  LODESTONE_CHECK(static_cast<std::int64_t>(observation.size()) == rows * observation_size_,
                  "TD3 policy: " + std::to_string(observation.size()) + " numbers are no rows of " +
                      std::to_string(observation_size_));
  const at::Tensor input =
      at::from_blob(const_cast<float*>(observation.data()), {rows, observation_size_}, at::kFloat);
  const at::Tensor action = policy(input.to(type_)).to(at::kFloat).contiguous();
  return {action.data_ptr<float>(), action.data_ptr<float>() + action.numel()};
}

inference::Actor Td3::actor() const {
  return {nets::to_arrays(actor_weights()), observation_size_, config_.hidden, action_size_};
}

UpdateResult Td3::update(const ReplayBuffer& buffer) {
  buffer.sample(random_, batch_);
  float* noise = noise_.data_ptr<float>();
  for (std::int64_t i = 0; i < noise_.numel(); ++i) {
    noise[i] = static_cast<float>(config_.policy_noise * random_.normal());
  }
  return update(batch_, noise_);
}

UpdateResult Td3::update(const Batch& batch, const at::Tensor& smoothing_noise) {
  check_batch(batch, smoothing_noise);
  ++updates_;
  return learn(batch, smoothing_noise, updates_ % config_.policy_frequency == 0);
}

void Td3::check_batch(const Batch& batch, const at::Tensor& noise) const {
  const std::int64_t rows = config_.batch_size;
  const auto check = [&](const at::Tensor& tensor, at::IntArrayRef shape, const char* name) {
    nets::check_tensor(tensor, shape, type_, std::string("TD3 update: ") + name);
  };
  check(batch.observation, {rows, observation_size_}, "observation");
  check(batch.action, {rows, action_size_}, "action");
  check(batch.reward, {rows}, "reward");
  check(batch.next_observation, {rows, observation_size_}, "next observation");
  check(batch.not_done, {rows}, "not_done");
  check(noise, {rows, action_size_}, "smoothing noise");
}

nets::NamedTensors Td3::actor_weights() const {
  nets::NamedTensors result;
  for (const auto& [name, tensor] : networks()) {
    if (name.rfind(kActorPrefix, 0) == 0)
      result[name.substr(std::char_traits<char>::length(kActorPrefix))] = tensor;
  }
  return result;
}

void Td3::save(nets::Checkpoint& checkpoint) const {
  const at::NoGradGuard no_grad;
  for (const auto& [name, tensor] : networks()) checkpoint.parts["networks"][name] = tensor.clone();
  for (const auto& [name, tensor] : optimiser()) checkpoint.parts["optimiser"][name] = tensor.clone();
  checkpoint.facts["td3"] = {{"updates", updates_}, {"random", random_.save()}};
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
    random_.restore(facts.at("random").get<std::string>());
  } catch (const nlohmann::json::exception& error) {
    throw common::CheckpointError(std::string("training checkpoint: td3 counters are malformed: ") +
                                  error.what());
  }
}

Td3Products products_here(Td3Products asked) {
  constexpr double kWorthIt = 1.5;
  return asked == Td3Products::kBfloat16 && inference::bf16_speedup() < kWorthIt ? Td3Products::kFloat32
                                                                                 : asked;
}

std::unique_ptr<Td3> make_td3(const Td3Config& config, std::int64_t observation_size,
                              std::int64_t action_size, std::uint64_t seed, std::int64_t threads,
                              at::ScalarType type) {
  const bool wide = type == at::kDouble;
  if (config.backend == Td3Backend::kAutograd) {
    if (wide) return std::make_unique<AutogradTd3<double>>(config, observation_size, action_size, seed);
    return std::make_unique<AutogradTd3<float>>(config, observation_size, action_size, seed);
  }
  if (wide) return std::make_unique<FusedTd3<double>>(config, observation_size, action_size, seed, threads);
  return std::make_unique<FusedTd3<float>>(config, observation_size, action_size, seed, threads);
}

}  // namespace lodestone::rl
