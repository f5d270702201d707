#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/task/task.h"

namespace lodestone::exports {

/// A stretch of a recording as an episode of a task. All arrays are row-major; T steps.
struct TaskEpisode {
  std::int64_t seed = 0;  ///< its goal was drawn by it
  task::Goal goal;
  std::vector<double> observations;        ///< [T + 1, O], see observation_columns()
  std::vector<double> actions;             ///< [T, A] in [-1, 1]
  std::vector<double> rewards;             ///< [T]
  std::vector<std::uint8_t> terminations;  ///< [T]
  std::vector<std::uint8_t> truncations;   ///< [T]
  std::vector<double> distance_m;          ///< [T + 1] to the goal
  std::vector<std::uint8_t> success;       ///< [T + 1] whether the pose counts as the goal's

  std::int64_t length() const { return static_cast<std::int64_t>(rewards.size()); }
};

/// What an observation holds, in this order: the pose as recorded (x_m, y_m, heading_rad of a needle), and of
/// a goal that is drawn target_x_m, target_y_m, and of a pose target_heading_rad.
std::vector<std::string> observation_columns(data::StateLayout layout, task::GoalKind goal);

/// The recording judged by a task as if somebody had driven for it: an episode ends where the task ends it,
/// and the next one begins there with a goal of its own; where the recording was cut it is truncated. Every
/// step is kept, those without current, too. An action is the recorded drive over the largest one, saturated
/// as training does. Goals depend on `seed` and the number of the episode only. Throws ConfigError when the
/// goal is a pose, and the recording has no heading.
std::vector<TaskEpisode> task_episodes(const data::Dataset& dataset, const task::TaskConfig& task,
                                       std::uint64_t seed);

}  // namespace lodestone::exports
