#include "lodestone/rl/hindsight.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::rl {

Hindsight::Hindsight(double fraction, const task::TaskConfig& task, const task::EncoderConfig& encoder,
                     std::int64_t environments, std::uint64_t seed,
                     std::shared_ptr<const task::Region> region)
    : fraction_(fraction),
      task_(task),
      encoder_(encoder),
      region_(std::move(region)),
      random_(seed, "hindsight"),
      episodes_(static_cast<std::size_t>(environments)) {
  check(task, encoder);
}

void Hindsight::check(const task::TaskConfig& task, const task::EncoderConfig& encoder) {
  if (task.goal != task::GoalKind::kPoint || !(encoder.target || encoder.relative_target))
    throw common::ConfigError(
        "training.hindsight needs a task whose goal is a point (task.goal = \"point\") that the "
        "policy sees (encoder.target or encoder.relative_target)");
}

void Hindsight::add(const std::vector<float>& observation, const std::vector<float>& action,
                    const env::StepResult& result, ReplayBuffer& buffer) {
  const auto row = [this](const std::vector<float>& rows, std::size_t i) {
    const auto columns = static_cast<std::ptrdiff_t>(rows.size() / episodes_.size());
    const auto first = rows.begin() + static_cast<std::ptrdiff_t>(i) * columns;
    return std::vector<float>(first, first + columns);
  };
  for (std::size_t i = 0; i < episodes_.size(); ++i) {
    const bool terminated = result.terminated[i] != 0;
    const bool truncated = result.truncated[i] != 0;
    episodes_[i].push_back({row(observation, i), row(action, i), row(result.final_observation, i), terminated,
                            result.success[i] != 0, result.penalty[i], result.progress[i]});
    if (!terminated && !truncated) continue;
    relabel(episodes_[i], buffer);
    episodes_[i].clear();
  }
}

bool Hindsight::may_be_goal(const Step& step) const {
  const geometry::Vector2 at_m = encoder_.position_m(step.next.data());
  return at_m.norm() <= task_.goal_radius_m() && (!region_ || region_->contains(at_m));
}

void Hindsight::relabel(const std::vector<Step>& episode, ReplayBuffer& buffer) {
  const auto pose = [this](const std::vector<float>& row) {
    const geometry::Vector2 at_m = encoder_.position_m(row.data());
    return geometry::Pose2{at_m.x(), at_m.y(), 0.0};
  };
  std::vector<std::size_t> goals;  // steps that ended where one may lie
  for (std::size_t t = 0; t < episode.size(); ++t)
    if (may_be_goal(episode[t])) goals.push_back(t);
  for (std::size_t t = 0; t < episode.size(); ++t) {
    const auto first = std::lower_bound(goals.begin(), goals.end(), t);
    if (first == goals.end()) return;
    if (random_.uniform() >= fraction_) continue;
    const auto ahead = static_cast<std::uint64_t>(goals.end() - first);
    const std::size_t later = *(first + static_cast<std::ptrdiff_t>(random_.below(ahead)));
    Step step = episode[t];
    task::Step judged;
    judged.before = pose(step.observation);
    judged.after = pose(step.next);
    judged.goal.position_m = encoder_.position_m(episode[later].next.data());
    judged.action = geometry::as_drive(step.action.data(), static_cast<int>(step.action.size()));
    judged.progress = step.progress;
    const task::StepOutcome outcome = task::evaluate_step(task_, judged);
    encoder_.retarget(judged.goal.position_m, step.observation.data());
    encoder_.retarget(judged.goal.position_m, step.next.data());
    // An end that was not the old goal's doing (the edge of the dish, say) stays one.
    const bool ended = step.terminated && !(task_.end_on_success && step.success);
    env::StepResult result;
    result.final_observation = step.next;
    result.reward = {static_cast<float>(outcome.reward - step.penalty)};
    result.terminated = {static_cast<std::uint8_t>(outcome.terminated || ended)};
    buffer.add(step.observation, step.action, result);
  }
}

common::Json Hindsight::save() const {
  common::Json state = {{"random", random_.save()}, {"episodes", common::Json::array()}};
  for (const std::vector<Step>& episode : episodes_) {
    common::Json steps = common::Json::array();
    for (const Step& step : episode)
      steps.push_back({step.observation, step.action, step.next, step.terminated, step.success, step.penalty,
                       step.progress});
    state["episodes"].push_back(std::move(steps));
  }
  return state;
}

void Hindsight::load(const common::Json& state) {
  try {
    random_.restore(state.at("random").get<std::string>());
    const common::Json& episodes = state.at("episodes");
    if (episodes.size() != episodes_.size())
      throw common::CheckpointError("training checkpoint: hindsight of another number of environments");
    for (std::size_t i = 0; i < episodes_.size(); ++i) {
      episodes_[i].clear();
      for (const common::Json& step : episodes[i]) {
        episodes_[i].push_back({step.at(0).get<std::vector<float>>(), step.at(1).get<std::vector<float>>(),
                                step.at(2).get<std::vector<float>>(), step.at(3).get<bool>(),
                                step.at(4).get<bool>(), step.at(5).get<double>(), step.at(6).get<double>()});
      }
    }
  } catch (const common::Json::exception& error) {
    throw common::CheckpointError(std::string("training checkpoint: hindsight is malformed: ") +
                                  error.what());
  }
}

}  // namespace lodestone::rl
