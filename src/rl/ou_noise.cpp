#include "lodestone/rl/ou_noise.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::rl {

ExplorationNoise::ExplorationNoise(const NoiseConfig& config, std::int64_t environments,
                                   std::int64_t action_size, std::uint64_t seed)
    : config_(config),
      action_size_(action_size),
      state_(static_cast<std::size_t>(environments * action_size), 0.0),
      noise_(torch::zeros({environments, action_size}, torch::kFloat32)),
      uniform_(torch::zeros({environments, action_size}, torch::kFloat32)) {
  streams_.reserve(static_cast<std::size_t>(environments));
  for (std::int64_t i = 0; i < environments; ++i) {
    streams_.emplace_back(seed, "exploration", static_cast<std::uint64_t>(i));
  }
}

const torch::Tensor& ExplorationNoise::next() {
  float* out = noise_.data_ptr<float>();
  const bool correlated = config_.kind == "ou";
  const double keep = correlated ? 1.0 - config_.theta * config_.dt : 0.0;
  const double step = correlated ? config_.sigma * std::sqrt(config_.dt) : config_.sigma;
  for (std::size_t i = 0; i < state_.size(); ++i) {
    common::RandomStream& stream = streams_[i / static_cast<std::size_t>(action_size_)];
    state_[i] = keep * state_[i] + step * stream.normal();
    out[i] = static_cast<float>(state_[i]);
  }
  return noise_;
}

const torch::Tensor& ExplorationNoise::uniform_actions() {
  float* out = uniform_.data_ptr<float>();
  for (std::size_t i = 0; i < state_.size(); ++i) {
    out[i] = static_cast<float>(streams_[i / static_cast<std::size_t>(action_size_)].uniform(-1.0, 1.0));
  }
  return uniform_;
}

void ExplorationNoise::episodes_ended(const torch::Tensor& ended) {
  LODESTONE_CHECK(ended.numel() == static_cast<std::int64_t>(streams_.size()) &&
                      ended.scalar_type() == torch::kUInt8 && ended.is_contiguous(),
                  "exploration noise: expected one uint8 per environment");
  if (!config_.reset_with_episode) return;
  for (std::size_t i = 0; i < state_.size(); ++i) {
    if (ended.data_ptr<std::uint8_t>()[i / static_cast<std::size_t>(action_size_)] != 0) state_[i] = 0.0;
  }
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
