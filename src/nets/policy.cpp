#include "lodestone/nets/policy.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/mlp.h"

namespace lodestone::nets {
namespace {

using common::CheckpointError;
using common::Json;

constexpr const char* kKind = "policy";
constexpr std::int64_t kExamples = 16;
constexpr double kExampleTolerance = 1e-5;

std::vector<std::int64_t> layer_sizes(std::int64_t inputs, const std::vector<std::int64_t>& hidden,
                                      std::int64_t outputs) {
  std::vector<std::int64_t> sizes = {inputs};
  sizes.insert(sizes.end(), hidden.begin(), hidden.end());
  sizes.push_back(outputs);
  return sizes;
}

/// Observations over the range encoders give, always the same.
torch::Tensor example_observations(std::int64_t size) {
  common::RandomStream random(1, "policy examples");
  torch::Tensor observations = torch::empty({kExamples, size});
  float* data = observations.data_ptr<float>();
  for (std::int64_t i = 0; i < observations.numel(); ++i)
    data[i] = static_cast<float>(random.uniform(-1.0, 1.0));
  return observations;
}

void check_examples(const Policy& policy, const NamedTensors& examples, const std::string& what) {
  if (examples.count("observation") == 0 || examples.count("action") == 0) {
    throw CheckpointError(what + ": example inputs and outputs are missing");
  }
  const torch::NoGradGuard no_grad;
  const torch::Tensor& observation = examples.at("observation");
  const std::int64_t size = task::ObservationEncoder(policy.encoder).size();
  if (observation.dim() != 2 || observation.size(1) != size) {
    throw CheckpointError(what + ": examples do not have the encoder's " + std::to_string(size) + " numbers");
  }
  Actor actor = policy.actor;
  const double error = (actor->forward(observation) - examples.at("action")).abs().max().item<double>();
  if (!(error <= kExampleTolerance)) {
    throw CheckpointError(what + ": recomputed example actions differ by " + std::to_string(error) +
                          ", at most 1e-5 is allowed; this build computes the network differently");
  }
}

}  // namespace

ActorImpl::ActorImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                     std::int64_t action_size)
    : layers_(register_linear_layers(*this, layer_sizes(observation_size, hidden, action_size))) {}

torch::Tensor ActorImpl::forward(const torch::Tensor& observation) {
  return torch::tanh(forward_relu(layers_, observation));
}

TwinCriticImpl::TwinCriticImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                               std::int64_t action_size) {
  const std::vector<std::int64_t> sizes = layer_sizes(observation_size + action_size, hidden, 1);
  first_ = register_linear_layers(*this, sizes, 1);
  second_ = register_linear_layers(*this, sizes, static_cast<int>(sizes.size()));
}

std::pair<torch::Tensor, torch::Tensor> TwinCriticImpl::forward(const torch::Tensor& observation,
                                                                const torch::Tensor& action) {
  const torch::Tensor input = torch::cat({observation, action}, 1);
  return {forward_relu(first_, input), forward_relu(second_, input)};
}

torch::Tensor TwinCriticImpl::first(const torch::Tensor& observation, const torch::Tensor& action) {
  return forward_relu(first_, torch::cat({observation, action}, 1));
}

void save_policy(const std::string& folder, const Policy& policy, const Json& run_config,
                 const Json& metrics) {
  LODESTONE_CHECK(!policy.actor.is_empty(), "the policy has no actor");
  const torch::NoGradGuard no_grad;
  Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = run_config;
  checkpoint.facts["hidden"] = policy.hidden;
  checkpoint.facts["encoder"] = task::encoder_to_json(policy.encoder);
  checkpoint.facts["action"] = task::action_to_json(policy.action);
  checkpoint.facts["goal"] = policy.goal;
  checkpoint.facts["rig"] = policy.rig;
  if (policy.region) checkpoint.facts["region"] = policy.region->json();
  checkpoint.facts["metrics"] = metrics;
  checkpoint.facts["provenance"] = policy.provenance;
  checkpoint.parts["actor"] = module_tensors(*policy.actor);
  Actor actor = policy.actor;
  const torch::Tensor observation = example_observations(task::ObservationEncoder(policy.encoder).size());
  checkpoint.parts["examples"] = {{"observation", observation}, {"action", actor->forward(observation)}};
  save_checkpoint(folder, checkpoint);
}

void set_policy_provenance(const std::string& folder, const Json& provenance) {
  Checkpoint checkpoint = load_checkpoint(folder, kKind);
  checkpoint.facts["provenance"] = provenance;
  save_checkpoint(folder, checkpoint);
}

Policy load_policy(const std::string& folder) {
  const Checkpoint checkpoint = load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  Policy policy;
  try {
    policy.hidden = checkpoint.facts.at("hidden").get<std::vector<std::int64_t>>();
    policy.encoder = task::encoder_from_json(checkpoint.facts.at("encoder"), what);
    policy.action = task::action_from_json(checkpoint.facts.at("action"), what);
    policy.goal = checkpoint.facts.at("goal").get<std::string>();
    policy.rig = checkpoint.facts.value("rig", Json());
    if (checkpoint.facts.contains("region"))
      policy.region = task::Region::from_json(checkpoint.facts["region"]);
    policy.provenance = checkpoint.facts.value("provenance", Json::object());
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const common::DataError& error) {
    throw CheckpointError(what + ": " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": encoder or action is malformed: " + error.what());
  }
  policy.actor = Actor(task::ObservationEncoder(policy.encoder).size(), policy.hidden);
  for (const char* part : {"actor", "examples"}) {
    if (checkpoint.parts.count(part) == 0) throw CheckpointError(what + ": part \"" + part + "\" is missing");
  }
  load_module_tensors(*policy.actor, checkpoint.parts.at("actor"), what + ", actor");
  policy.actor->eval();
  check_examples(policy, checkpoint.parts.at("examples"), what);
  return policy;
}

}  // namespace lodestone::nets
