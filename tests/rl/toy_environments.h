#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/env/vec_env.h"

namespace lodestone::rl::testing {

/// A point in [-1, 1]^2 that each step moves by 0.25 times the action; reward -(|x| + |y|) after the step,
/// cut after eight steps. The axes are independent, so the best return is known: each goes to zero as fast as
/// it can.
class PointEnv final : public env::VecEnv {
 public:
  static constexpr int kLength = 8;
  static constexpr double kStride = 0.25;

  PointEnv(std::int64_t count, std::uint64_t seed) : count_(count) {
    for (std::int64_t i = 0; i < count; ++i)
      streams_.emplace_back(seed, "point", static_cast<std::uint64_t>(i));
    position_ = torch::zeros({count, 2}, torch::kFloat32);
    steps_ = torch::zeros({count}, torch::kInt64);
  }

  /// Return of the best policy from a start, by arithmetic.
  static double best_return(double x, double y) {
    double total = 0.0;
    for (int t = 1; t <= kLength; ++t) {
      total -= std::max(0.0, std::abs(x) - kStride * t) + std::max(0.0, std::abs(y) - kStride * t);
    }
    return total;
  }

  env::EnvSpec spec() const override { return {count_, 2, 2}; }

  torch::Tensor reset() override {
    for (std::int64_t i = 0; i < count_; ++i) restart(i);
    return position_.clone();
  }

  env::StepResult step(const torch::Tensor& actions) override {
    env::StepResult result;
    position_.add_(actions.clamp(-1.0, 1.0), kStride).clamp_(-1.0, 1.0);
    result.reward = -position_.abs().sum(1);
    result.final_observation = position_.clone();
    result.terminated = torch::zeros({count_}, torch::kUInt8);
    result.truncated = torch::zeros({count_}, torch::kUInt8);
    result.success = (position_.abs().amax(1) < 0.05).to(torch::kUInt8);
    for (std::int64_t i = 0; i < count_; ++i) {
      std::int64_t& taken = steps_.data_ptr<std::int64_t>()[i];
      if (++taken < kLength) continue;
      result.truncated[i] = 1;
      restart(i);
    }
    result.observation = position_.clone();
    return result;
  }

  void exchange_state(env::EnvState& state, bool load) override {
    if (load) {
      position_.copy_(state.tensors.at("position"));
      steps_.copy_(state.tensors.at("steps"));
      for (std::size_t i = 0; i < streams_.size(); ++i)
        streams_[i].restore(state.facts[i].get<std::string>());
      return;
    }
    state.tensors = {{"position", position_.clone()}, {"steps", steps_.clone()}};
    state.facts = common::Json::array();
    for (const common::RandomStream& stream : streams_) state.facts.push_back(stream.save());
  }

 private:
  void restart(std::int64_t i) {
    common::RandomStream& stream = streams_[static_cast<std::size_t>(i)];
    position_[i][0] = stream.uniform(-1.0, 1.0);
    position_[i][1] = stream.uniform(-1.0, 1.0);
    steps_[i] = 0;
  }

  std::int64_t count_;
  std::vector<common::RandomStream> streams_;
  torch::Tensor position_;
  torch::Tensor steps_;
};

/// One state. Each step pays 1 - |a - best|^2 and every `length`-th step ends the episode, by termination or
/// by truncation. The best value is 1 when every step terminates and 1 / (1 - discount) when episodes are
/// only cut.
class BanditEnv final : public env::VecEnv {
 public:
  BanditEnv(std::int64_t count, float best_x, float best_y, int length, bool terminates)
      : count_(count), best_(torch::tensor({best_x, best_y})), length_(length), terminates_(terminates) {}

  env::EnvSpec spec() const override { return {count_, 1, 2}; }
  torch::Tensor reset() override { return torch::ones({count_, 1}); }

  env::StepResult step(const torch::Tensor& actions) override {
    const bool ends = ++taken_ % length_ == 0;
    env::StepResult result;
    result.observation = torch::ones({count_, 1});
    result.final_observation = torch::ones({count_, 1});
    result.reward = 1.0 - (actions - best_).square().sum(1);
    result.terminated = torch::full({count_}, ends && terminates_ ? 1 : 0, torch::kUInt8);
    result.truncated = torch::full({count_}, ends && !terminates_ ? 1 : 0, torch::kUInt8);
    result.success = torch::zeros({count_}, torch::kUInt8);
    return result;
  }
  void exchange_state(env::EnvState& state, bool load) override {
    if (load) {
      taken_ = state.facts["taken"].get<int>();
    } else {
      state.facts["taken"] = taken_;
    }
  }

 private:
  std::int64_t count_;
  torch::Tensor best_;
  int length_;
  bool terminates_;
  int taken_ = 0;
};

}  // namespace lodestone::rl::testing
