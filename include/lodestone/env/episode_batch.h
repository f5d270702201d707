#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/data/dataset_info.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/task.h"

namespace lodestone::env {

/// What N environments play: the same for every kind of environment.
struct EpisodeSettings {
  std::int64_t count = 1;
  task::TaskConfig task;
  task::EncoderConfig encoder;
  task::ActionConfig action;
  std::uint64_t seed = 1;
  std::uint64_t first_stream = 0;  ///< of the random streams of `seed`: environment i draws from i further
  std::shared_ptr<const task::Region> region;  ///< starts and goals lie in it; everywhere when null
  std::int64_t shrink_steps =
      0;  ///< steps of one environment over which the success radius shrinks; 0: it has
};

/// Fills in what the data that a simulator was learned from say of the rig: its reach, the numbers of
/// an action, the drive that 1 means, the one-axis rule, and that there is no heading.
void adopt_data(const data::DatasetInfo& info, task::TaskConfig& task, task::EncoderConfig& encoder,
                task::ActionConfig& action);

/// The same of a rig as it is described, in A.
void adopt_rig(const physics::RigDescription& rig, task::TaskConfig& task, task::EncoderConfig& encoder,
               task::ActionConfig& action);

/// What an environment adds to the task's own rules.
struct StepEnd {
  double penalty = 0.0;     ///< taken from the reward
  bool terminated = false;  ///< the episode ends here, as if by the rules
  bool truncated = false;   ///< the episode is cut here, as if by the step limit
};

/// What the pose sensor adds to the true pose, normally distributed and new in every step.
struct SensorNoise {
  double position_m = 0.0;
  double heading_rad = 0.0;
};

/// The episodes of N environments: starts, goals, observations, rewards and ends; everything except how the
/// robot moves. Environment i draws from its own stream, so any shard of environments may be worked on by any
/// thread.
class EpisodeBatch {
 public:
  /// `name` names the random streams: (seed, name, first_stream + i).
  EpisodeBatch(const EpisodeSettings& settings, const SensorNoise& noise, const std::string& name);

  EnvSpec spec() const;
  const EpisodeSettings& settings() const { return settings_; }
  common::RandomStream& random(std::size_t i) { return slots_[i].random; }
  const geometry::Pose2& pose(std::size_t i) const { return slots_[i].pose; }

  /// Throws LogicFault unless `actions` are [N, A].
  void check_actions(const std::vector<float>& actions) const;

  /// A new episode in environment i. Start and goal are drawn again (a few times at most) when the start
  /// already counts as reached and reaching ends an episode. `gain`: what the policy is told of the rig.
  void begin(std::size_t i, const std::function<geometry::Pose2(common::RandomStream&)>& draw_start,
             const std::optional<task::DriveGain>& gain = {});
  /// The drive of A numbers in [-1, 1]; remembers the action.
  geometry::Drive drive(std::size_t i, const float* action);
  /// Remembers an action that something else chose, in [-1, 1].
  void note_action(std::size_t i, const geometry::Drive& action) { slots_[i].seen.last_action = action; }
  /// The robot came to `next`: writes reward, ends and final observation. True when the episode ended: the
  /// caller then calls begin().
  bool finish(std::size_t i, const geometry::Pose2& next, const StepEnd& extra = {});

  const std::vector<float>& observation() const { return result_.observation; }
  const StepResult& result() const { return result_; }
  Snapshot save() const;
  void load(const Snapshot& snapshot);

 private:
  struct Slot {
    explicit Slot(common::RandomStream stream) : random(std::move(stream)) {}
    geometry::Pose2 pose;
    task::Observation seen;
    std::int64_t step = 0;
    std::int64_t age = 0;  // steps of all episodes so far
    common::RandomStream random;
  };

  geometry::Pose2 sense(Slot& slot) const;
  /// Numbers of a slot that outlive a step.
  std::int64_t slot_numbers() const;
  /// Of the training: how far the success radius has shrunk for this environment.
  double progress(const Slot& slot) const;

  EpisodeSettings settings_;
  SensorNoise noise_;
  task::ObservationEncoder encoder_;
  std::size_t columns_;
  std::vector<Slot> slots_;
  StepResult result_;
};

/// Throws CheckpointError unless the snapshot holds array `name` of `shape`, of that type; returns its
/// numbers.
template <class Number>
const Number* snapshot_numbers(const Snapshot& snapshot, const std::string& name,
                               const std::vector<std::int64_t>& shape) {
  const auto found = snapshot.arrays.find(name);
  if (found == snapshot.arrays.end() || found->second.shape() != shape ||
      found->second.type() != inference::element_type<Number>()) {
    throw common::CheckpointError(
        "state of the environments: array \"" + name +
        "\" is missing or of another shape; resume with the same number of environments");
  }
  inference::check_finite(found->second, "state of the environments: array \"" + name + "\"");
  return found->second.data<Number>();
}

}  // namespace lodestone::env
