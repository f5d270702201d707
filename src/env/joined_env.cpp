#include "lodestone/env/joined_env.h"

#include <string>

#include "lodestone/common/error.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::env {
namespace {

std::string prefix(std::size_t part) { return "part_" + std::to_string(part) + "/"; }

}  // namespace

JoinedEnv::JoinedEnv(std::vector<std::unique_ptr<VecEnv>> parts) : parts_(std::move(parts)) {
  LODESTONE_CHECK(!parts_.empty(), "at least one batch of environments");
  spec_ = parts_.front()->spec();
  spec_.count = 0;
  for (const auto& part : parts_) {
    const EnvSpec spec = part->spec();
    LODESTONE_CHECK(spec.observation_size == spec_.observation_size && spec.action_size == spec_.action_size,
                    "joined environments of the same sizes");
    spec_.count += spec.count;
  }
}

torch::Tensor JoinedEnv::reset() {
  std::vector<torch::Tensor> observations;
  for (const auto& part : parts_) observations.push_back(part->reset());
  return torch::cat(observations);
}

StepResult JoinedEnv::step(const torch::Tensor& actions) {
  nets::check_tensor(actions, "actions", {spec_.count, spec_.action_size}, torch::kFloat32);
  std::vector<StepResult> results;
  std::int64_t first = 0;
  for (const auto& part : parts_) {
    const torch::Tensor asked = actions.narrow(0, first, part->spec().count);
    first += part->spec().count;
    results.push_back(part->step(asked));
    if (!results.back().action.defined()) results.back().action = asked;
  }
  const auto join = [&results](torch::Tensor StepResult::*field) {
    std::vector<torch::Tensor> rows;
    for (const StepResult& result : results) rows.push_back(result.*field);
    return torch::cat(rows);
  };
  return {join(&StepResult::observation), join(&StepResult::reward),  join(&StepResult::terminated),
          join(&StepResult::truncated),   join(&StepResult::success), join(&StepResult::final_observation),
          join(&StepResult::action)};
}

void JoinedEnv::exchange_state(EnvState& state, bool load) {
  if (load && !state.facts.contains("parts"))
    throw common::CheckpointError("state of the environments: it is not one of joined environments");
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    EnvState part;
    if (load) {
      if (k < state.facts["parts"].size()) part.facts = state.facts["parts"][k];
      for (const auto& [name, tensor] : state.tensors) {
        if (name.rfind(prefix(k), 0) == 0) part.tensors[name.substr(prefix(k).size())] = tensor;
      }
    }
    parts_[k]->exchange_state(part, load);
    if (load) continue;
    state.facts["parts"].push_back(part.facts);
    for (const auto& [name, tensor] : part.tensors) state.tensors[prefix(k) + name] = tensor;
  }
}

}  // namespace lodestone::env
