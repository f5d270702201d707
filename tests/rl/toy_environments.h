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

  PointEnv(std::int64_t count, std::uint64_t seed)
      : count_(static_cast<std::size_t>(count)), position_(2 * count_), steps_(count_) {
    for (std::size_t i = 0; i < count_; ++i) streams_.emplace_back(seed, "point", i);
  }

  /// Return of the best policy from a start, by arithmetic.
  static double best_return(double x, double y) {
    double total = 0.0;
    for (int t = 1; t <= kLength; ++t) {
      total -= std::max(0.0, std::abs(x) - kStride * t) + std::max(0.0, std::abs(y) - kStride * t);
    }
    return total;
  }

  env::EnvSpec spec() const override { return {static_cast<std::int64_t>(count_), 2, 2}; }

  const std::vector<float>& reset() override {
    for (std::size_t i = 0; i < count_; ++i) restart(i);
    return position_;
  }

  const env::StepResult& step(const std::vector<float>& actions) override {
    for (std::size_t k = 0; k < position_.size(); ++k) {
      const float stride = static_cast<float>(kStride) * std::clamp(actions[k], -1.0F, 1.0F);
      position_[k] = std::clamp(position_[k] + stride, -1.0F, 1.0F);
    }
    result_.final_observation = position_;
    result_.terminated.assign(count_, 0);
    result_.truncated.assign(count_, 0);
    result_.success.assign(count_, 0);
    result_.reward.assign(count_, 0.0F);
    result_.penalty.assign(count_, 0.0);
    result_.progress.assign(count_, 1.0);
    for (std::size_t i = 0; i < count_; ++i) {
      const float x = std::abs(position_[2 * i]);
      const float y = std::abs(position_[2 * i + 1]);
      result_.reward[i] = -(x + y);
      result_.success[i] = std::max(x, y) < 0.05F ? 1 : 0;
      if (++steps_[i] < kLength) continue;
      result_.truncated[i] = 1;
      restart(i);
    }
    result_.observation = position_;
    return result_;
  }

  env::Snapshot save() const override {
    env::Snapshot snapshot;
    const auto count = static_cast<std::int64_t>(count_);
    snapshot.arrays = {{"position", {position_, {count, 2}}}, {"steps", {steps_, {count}}}};
    snapshot.facts = common::Json::array();
    for (const common::RandomStream& stream : streams_) snapshot.facts.push_back(stream.save());
    return snapshot;
  }

  void load(const env::Snapshot& snapshot) override {
    position_ = snapshot.arrays.at("position").to_vector<float>();
    steps_ = snapshot.arrays.at("steps").to_vector<std::int64_t>();
    for (std::size_t i = 0; i < streams_.size(); ++i)
      streams_[i].restore(snapshot.facts[i].get<std::string>());
  }

 private:
  void restart(std::size_t i) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      position_[2 * i + axis] = static_cast<float>(streams_[i].uniform(-1.0, 1.0));
    steps_[i] = 0;
  }

  std::size_t count_;
  std::vector<common::RandomStream> streams_;
  std::vector<float> position_;
  std::vector<std::int64_t> steps_;
  env::StepResult result_;
};

/// One state. Each step pays 1 - |a - best|^2 and every `length`-th step ends the episode, by termination or
/// by truncation. The best value is 1 when every step terminates and 1 / (1 - discount) when episodes are
/// only cut.
class BanditEnv final : public env::VecEnv {
 public:
  BanditEnv(std::int64_t count, float best_x, float best_y, int length, bool terminates)
      : count_(static_cast<std::size_t>(count)),
        best_{best_x, best_y},
        length_(length),
        terminates_(terminates) {
    result_.observation.assign(count_, 1.0F);
    result_.final_observation.assign(count_, 1.0F);
    result_.success.assign(count_, 0);
    result_.penalty.assign(count_, 0.0);
    result_.progress.assign(count_, 1.0);
    result_.reward.resize(count_);
  }

  env::EnvSpec spec() const override { return {static_cast<std::int64_t>(count_), 1, 2}; }
  const std::vector<float>& reset() override { return result_.observation; }

  const env::StepResult& step(const std::vector<float>& actions) override {
    const bool ends = ++taken_ % length_ == 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const float x = actions[2 * i] - best_[0];
      const float y = actions[2 * i + 1] - best_[1];
      result_.reward[i] = 1.0F - (x * x + y * y);
    }
    result_.terminated.assign(count_, ends && terminates_ ? 1 : 0);
    result_.truncated.assign(count_, ends && !terminates_ ? 1 : 0);
    return result_;
  }
  env::Snapshot save() const override {
    env::Snapshot snapshot;
    snapshot.facts["taken"] = taken_;
    return snapshot;
  }
  void load(const env::Snapshot& snapshot) override { taken_ = snapshot.facts["taken"].get<int>(); }

 private:
  std::size_t count_;
  float best_[2];
  int length_;
  bool terminates_;
  int taken_ = 0;
  env::StepResult result_;
};

}  // namespace lodestone::rl::testing
