#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/rl/replay_buffer.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"
#include "lodestone/task/task.h"

namespace lodestone::rl {

/// Hindsight relabelling (Andrychowicz et al., 2017, strategy "future"): when an episode has ended, a
/// fraction of its steps goes into the buffer once more, as if the aim had been a place the needle came to
/// later in it, of those where the task may set one. Reward and ends are what the environment would have said
/// then, from sensed positions.
class Hindsight {
 public:
  /// Throws ConfigError unless the task's goal is a point that the encoder shows.
  static void check(const task::TaskConfig& task, const task::EncoderConfig& encoder);

  /// `fraction` of the steps; goals lie in `region`, when given. Throws as check() does.
  Hindsight(double fraction, const task::TaskConfig& task, const task::EncoderConfig& encoder,
            std::int64_t environments, std::uint64_t seed,
            std::shared_ptr<const task::Region> region = nullptr);

  /// Takes in a step of all environments, as ReplayBuffer::add does, and adds relabelled steps to `buffer`.
  void add(const std::vector<float>& observation, const std::vector<float>& action,
           const env::StepResult& result, ReplayBuffer& buffer);

  /// The episodes under way, and back. load throws CheckpointError.
  common::Json save() const;
  void load(const common::Json& state);

 private:
  struct Step {
    std::vector<float> observation, action, next;
    bool terminated = false;
    bool success = false;
    double penalty = 0.0;
    double progress = 1.0;
  };
  /// Whether the task may set a goal where this step ended.
  bool may_be_goal(const Step& step) const;
  void relabel(const std::vector<Step>& episode, ReplayBuffer& buffer);

  double fraction_;
  task::TaskConfig task_;
  task::ObservationEncoder encoder_;
  std::shared_ptr<const task::Region> region_;
  common::RandomStream random_;
  std::vector<std::vector<Step>> episodes_;  // [N], under way
};

}  // namespace lodestone::rl
