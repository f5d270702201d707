#include "lodestone/rl/ou_noise.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::rl {

ExplorationNoise::ExplorationNoise(const NoiseConfig& config, std::int64_t environments,
                                   std::int64_t action_size, std::uint64_t seed)
    : keep_(config.kind == NoiseKind::kGaussian ? 0.0 : 1.0 - config.theta * config.dt),
      step_(config.kind == NoiseKind::kGaussian ? config.sigma : config.sigma * std::sqrt(config.dt)),
      reset_with_episode_(config.reset_with_episode),
      action_size_(static_cast<std::size_t>(action_size)),
      state_(static_cast<std::size_t>(environments * action_size), 0.0) {
  streams_.reserve(static_cast<std::size_t>(environments));
  for (std::int64_t i = 0; i < environments; ++i) {
    streams_.emplace_back(seed, "exploration", static_cast<std::uint64_t>(i));
  }
}

std::vector<float> ExplorationNoise::next() {
  std::vector<float> noise(state_.size());
  for (std::size_t i = 0; i < state_.size(); ++i) {
    common::RandomStream& stream = streams_[i / action_size_];
    state_[i] = keep_ * state_[i] + step_ * stream.normal();
    noise[i] = static_cast<float>(state_[i]);
  }
  return noise;
}

std::vector<float> ExplorationNoise::uniform_actions() {
  std::vector<float> actions(state_.size());
  for (std::size_t i = 0; i < state_.size(); ++i) {
    actions[i] = static_cast<float>(streams_[i / action_size_].uniform(-1.0, 1.0));
  }
  return actions;
}

void ExplorationNoise::episode_ended(std::size_t environment) {
  if (!reset_with_episode_) return;
  std::fill_n(state_.begin() + static_cast<std::ptrdiff_t>(environment * action_size_), action_size_, 0.0);
}

common::Json ExplorationNoise::save() const {
  common::Json json;
  json["state"] = state_;
  json["streams"] = common::Json::array();
  for (const common::RandomStream& stream : streams_) json["streams"].push_back(stream.save());
  return json;
}

void ExplorationNoise::load(const common::Json& state) {
  if (!state.contains("state") || !state.contains("streams") || state["state"].size() != state_.size() ||
      state["streams"].size() != streams_.size()) {
    throw common::CheckpointError("exploration noise: the checkpoint does not hold " +
                                  std::to_string(streams_.size()) +
                                  " environments: resume with the configuration it was made with");
  }
  state_ = state["state"].get<std::vector<double>>();
  for (std::size_t i = 0; i < streams_.size(); ++i)
    streams_[i].restore(state["streams"][i].get<std::string>());
}

}  // namespace lodestone::rl
