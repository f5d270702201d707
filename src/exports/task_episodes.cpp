#include "lodestone/exports/task_episodes.h"

#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::exports {
namespace {

/// One recorded episode, by step.
class Recorded {
 public:
  Recorded(const data::Episode& episode, const data::DatasetInfo& info)
      : episode_(episode),
        state_size_(static_cast<std::size_t>(data::state_size(info.layout))),
        action_size_(info.action_size),
        scale_(info.action_scale) {}

  std::size_t steps() const { return static_cast<std::size_t>(episode_.length()); }
  geometry::Pose2 pose(std::size_t row) const {
    const double* state = &episode_.observations[row * state_size_];
    return {state[0], state[1], state_size_ == 3 ? state[2] : 0.0};
  }
  geometry::Drive action(std::size_t step) const {
    const double* drive = &episode_.actions[step * static_cast<std::size_t>(action_size_)];
    return geometry::saturated(geometry::as_drive(drive, action_size_) / scale_);
  }

 private:
  const data::Episode& episode_;
  std::size_t state_size_;
  int action_size_;
  double scale_;
};

class Judge {
 public:
  Judge(const data::DatasetInfo& info, const task::TaskConfig& task, std::uint64_t seed)
      : layout_(info.layout), task_(task), seed_(seed) {}

  void judge(const Recorded& recorded, std::vector<TaskEpisode>& out) const {
    std::optional<TaskEpisode> episode;
    for (std::size_t t = 0; t < recorded.steps(); ++t) {
      if (!episode) episode = begun(recorded.pose(t), out.size());
      const task::StepOutcome outcome = add_step(recorded, t, *episode);
      const bool cut = t + 1 == recorded.steps() && !outcome.terminated;
      if (cut) episode->truncations.back() = 1;
      if (!outcome.terminated && !outcome.truncated && !cut) continue;
      out.push_back(std::move(*episode));
      episode.reset();
    }
  }

 private:
  TaskEpisode begun(const geometry::Pose2& pose, std::size_t number) const {
    TaskEpisode episode;
    // 63 bits: Python's readers take seeds for signed numbers.
    episode.seed = static_cast<std::int64_t>(common::derive_seed(seed_, "task episode", number) >> 1U);
    common::RandomStream random(static_cast<std::uint64_t>(episode.seed), "goal");
    episode.goal = task::draw_goal(task_, random);
    see(pose, episode);
    return episode;
  }

  task::StepOutcome add_step(const Recorded& recorded, std::size_t t, TaskEpisode& episode) const {
    task::Step step;
    step.before = recorded.pose(t);
    step.after = recorded.pose(t + 1);
    step.goal = episode.goal;
    step.action = recorded.action(t);
    step.index = episode.length() + 1;
    const task::StepOutcome outcome = task::evaluate_step(task_, step);
    episode.actions.insert(episode.actions.end(), step.action.begin(), step.action.end());
    episode.rewards.push_back(outcome.reward);
    episode.terminations.push_back(outcome.terminated ? 1 : 0);
    episode.truncations.push_back(outcome.truncated ? 1 : 0);
    see(step.after, episode);
    return outcome;
  }

  void see(const geometry::Pose2& pose, TaskEpisode& episode) const {
    const task::Goal& goal = episode.goal;
    std::vector<double>& row = episode.observations;
    row.insert(row.end(), {pose.x_m, pose.y_m});
    if (layout_ == data::StateLayout::kPose) row.push_back(pose.heading_rad);
    if (task_.goal != task::GoalKind::kCentre)
      row.insert(row.end(), {goal.position_m.x(), goal.position_m.y()});
    if (goal.heading_rad) row.push_back(*goal.heading_rad);
    episode.distance_m.push_back((pose.position_m() - goal.position_m).norm());
    episode.success.push_back(task::reached(task_, pose, goal, 1.0) ? 1 : 0);
  }

  data::StateLayout layout_;
  const task::TaskConfig& task_;
  std::uint64_t seed_;
};

}  // namespace

std::vector<std::string> observation_columns(data::StateLayout layout, task::GoalKind goal) {
  std::vector<std::string> columns = {"x_m", "y_m"};
  if (layout == data::StateLayout::kPose) columns.emplace_back("heading_rad");
  if (goal != task::GoalKind::kCentre) columns.insert(columns.end(), {"target_x_m", "target_y_m"});
  if (goal == task::GoalKind::kPose) columns.emplace_back("target_heading_rad");
  return columns;
}

std::vector<TaskEpisode> task_episodes(const data::Dataset& dataset, const task::TaskConfig& task,
                                       std::uint64_t seed) {
  if (task.goal == task::GoalKind::kPose && dataset.info.layout != data::StateLayout::kPose)
    throw common::ConfigError(
        "task.goal = \"pose\", but the recording has no heading: set it to centre or point");
  std::vector<TaskEpisode> episodes;
  const Judge judge(dataset.info, task, seed);
  for (const data::Episode& episode : dataset.episodes)
    judge.judge(Recorded(episode, dataset.info), episodes);
  return episodes;
}

}  // namespace lodestone::exports
