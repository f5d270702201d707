#include "lodestone/env/joined_env.h"

#include <string>

#include "lodestone/common/error.h"

namespace lodestone::env {
namespace {

std::string prefix(std::size_t part) { return "part_" + std::to_string(part) + "/"; }

template <class Number>
void append(std::vector<Number>& all, const std::vector<Number>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

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

const std::vector<float>& JoinedEnv::reset() {
  result_.observation.clear();
  for (const auto& part : parts_) append(result_.observation, part->reset());
  return result_.observation;
}

const StepResult& JoinedEnv::step(const std::vector<float>& actions) {
  LODESTONE_CHECK(actions.size() == static_cast<std::size_t>(spec_.count * spec_.action_size),
                  "actions of all joined environments");
  result_ = {};
  auto next = actions.begin();
  for (const auto& part : parts_) {
    const auto end = next + part->spec().count * spec_.action_size;
    const std::vector<float> asked(next, end);
    next = end;
    const StepResult& result = part->step(asked);
    append(result_.observation, result.observation);
    append(result_.reward, result.reward);
    append(result_.terminated, result.terminated);
    append(result_.truncated, result.truncated);
    append(result_.success, result.success);
    append(result_.final_observation, result.final_observation);
    append(result_.action, result.action.empty() ? asked : result.action);
    append(result_.penalty, result.penalty);
    append(result_.progress, result.progress);
  }
  return result_;
}

Snapshot JoinedEnv::save() const {
  Snapshot snapshot;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const Snapshot part = parts_[k]->save();
    snapshot.facts["parts"].push_back(part.facts);
    for (const auto& [name, array] : part.arrays) snapshot.arrays[prefix(k) + name] = array;
  }
  return snapshot;
}

void JoinedEnv::load(const Snapshot& snapshot) {
  if (!snapshot.facts.contains("parts"))
    throw common::CheckpointError("state of the environments: it is not one of joined environments");
  const common::Json& facts = snapshot.facts.at("parts");
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    Snapshot part;
    if (k < facts.size()) part.facts = facts.at(k);
    for (const auto& [name, array] : snapshot.arrays) {
      if (name.rfind(prefix(k), 0) == 0) part.arrays[name.substr(prefix(k).size())] = array;
    }
    parts_[k]->load(part);
  }
}

}  // namespace lodestone::env
