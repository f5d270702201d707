#include "lodestone/env/episode_batch.h"

#include <algorithm>

#include "lodestone/common/error.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::env {
namespace {

constexpr int kStartTries = 16;
constexpr std::int64_t kSlotNumbers = 13;

/// The numbers of a slot that outlive a step, in the order checkpoints hold them.
template <class Visit>
void visit_numbers(geometry::Pose2& pose, task::Observation& seen, double& target_heading_rad,
                   Visit&& visit) {
  for (double* value :
       {&pose.x_m, &pose.y_m, &pose.heading_rad, &seen.pose.x_m, &seen.pose.y_m, &seen.pose.heading_rad,
        &seen.target_m.x(), &seen.target_m.y(), &target_heading_rad, &seen.last_action.x(),
        &seen.last_action.y(), &seen.last_displacement_m.x(), &seen.last_displacement_m.y()}) {
    visit(*value);
  }
}

}  // namespace

const torch::Tensor& state_tensor(const EnvState& state, const std::string& name, const torch::Tensor& like) {
  const auto found = state.tensors.find(name);
  if (found == state.tensors.end() || found->second.sizes() != like.sizes() ||
      found->second.scalar_type() != like.scalar_type()) {
    throw common::CheckpointError(
        "state of the environments: tensor \"" + name +
        "\" is missing or of another shape; resume with the same number of environments");
  }
  return found->second;
}

EpisodeBatch::EpisodeBatch(const EpisodeSettings& settings, const SensorNoise& noise, const std::string& name)
    : settings_(settings), noise_(noise), encoder_(settings.encoder), columns_(encoder_.size()) {
  if (settings.count < 1) {
    throw common::ConfigError("the number of environments must be at least 1, not " +
                              std::to_string(settings.count));
  }
  slots_.reserve(static_cast<std::size_t>(settings.count));
  for (std::int64_t i = 0; i < settings.count; ++i) {
    slots_.push_back(
        {{}, {}, 0, 0, common::RandomStream(settings.seed, name, static_cast<std::uint64_t>(i))});
  }
  result_.observation = torch::zeros({settings.count, columns_});
  result_.final_observation = torch::zeros({settings.count, columns_});
  result_.reward = torch::zeros({settings.count});
  result_.terminated = torch::zeros({settings.count}, torch::kUInt8);
  result_.truncated = torch::zeros({settings.count}, torch::kUInt8);
  result_.success = torch::zeros({settings.count}, torch::kUInt8);
}

EnvSpec EpisodeBatch::spec() const { return {settings_.count, columns_, 2}; }

void EpisodeBatch::check_actions(const torch::Tensor& actions) const {
  nets::check_tensor(actions, "actions", {settings_.count, 2}, torch::kFloat32);
}

geometry::Pose2 EpisodeBatch::sense(Slot& slot) const {
  geometry::Pose2 sensed = slot.pose;
  if (noise_.position_m > 0.0) {
    sensed.x_m += noise_.position_m * slot.random.normal();
    sensed.y_m += noise_.position_m * slot.random.normal();
  }
  if (noise_.heading_rad > 0.0) {
    sensed.heading_rad = geometry::wrap_angle(sensed.heading_rad + noise_.heading_rad * slot.random.normal());
  }
  return sensed;
}

void EpisodeBatch::begin(std::size_t i,
                         const std::function<geometry::Pose2(common::RandomStream&)>& draw_start) {
  Slot& slot = slots_[i];
  const task::TaskConfig& task = settings_.task;
  slot.seen = {};
  slot.step = 0;
  for (int attempt = 0; attempt < kStartTries; ++attempt) {
    slot.pose = draw_start(slot.random);
    const task::Goal goal = task::draw_goal(task, slot.random, settings_.region.get());
    slot.seen.target_m = goal.position_m;
    if (task.goal == "pose") slot.seen.target_heading_rad = goal.heading_rad;
    const double distance_m = (slot.pose.position_m() - slot.seen.target_m).norm();
    if (!task.end_on_success || distance_m >= task.success_radius_m) break;
  }
  slot.seen.pose = sense(slot);
  encoder_.encode(slot.seen, result_.observation.data_ptr<float>() + static_cast<std::int64_t>(i) * columns_);
}

geometry::Vector2 EpisodeBatch::drive(std::size_t i, const float* action) {
  const geometry::Vector2 wanted(std::clamp(static_cast<double>(action[0]), -1.0, 1.0),
                                 std::clamp(static_cast<double>(action[1]), -1.0, 1.0));
  slots_[i].seen.last_action = wanted;
  return task::axis_drive(wanted, settings_.action);
}

bool EpisodeBatch::finish(std::size_t i, const geometry::Pose2& next, const StepEnd& extra) {
  Slot& slot = slots_[i];
  ++slot.step;
  ++slot.age;
  task::Step step;
  step.before = slot.pose;
  step.after = next;
  step.goal = {slot.seen.target_m, slot.seen.target_heading_rad.value_or(0.0)};
  step.action = slot.seen.last_action;
  step.index = slot.step;
  if (settings_.shrink_steps > 0)
    step.progress = static_cast<double>(slot.age) / static_cast<double>(settings_.shrink_steps);
  task::StepOutcome outcome = task::evaluate_step(settings_.task, step);
  outcome.reward -= extra.penalty;
  outcome.terminated = outcome.terminated || extra.terminated;
  outcome.truncated = !outcome.terminated && (outcome.truncated || extra.truncated);
  slot.pose = next;
  const geometry::Vector2 before_m = slot.seen.pose.position_m();
  slot.seen.pose = sense(slot);
  slot.seen.last_displacement_m = slot.seen.pose.position_m() - before_m;

  result_.reward.data_ptr<float>()[i] = static_cast<float>(outcome.reward);
  result_.terminated.data_ptr<std::uint8_t>()[i] = outcome.terminated ? 1 : 0;
  result_.truncated.data_ptr<std::uint8_t>()[i] = outcome.truncated ? 1 : 0;
  result_.success.data_ptr<std::uint8_t>()[i] = outcome.success ? 1 : 0;
  const std::int64_t row = static_cast<std::int64_t>(i) * columns_;
  float* final_row = result_.final_observation.data_ptr<float>() + row;
  encoder_.encode(slot.seen, final_row);
  if (outcome.terminated || outcome.truncated) return true;
  std::copy_n(final_row, columns_, result_.observation.data_ptr<float>() + row);
  return false;
}

void EpisodeBatch::exchange_state(EnvState& state, bool load) {
  const auto count = static_cast<std::int64_t>(slots_.size());
  torch::Tensor numbers = torch::empty({count, kSlotNumbers}, torch::kFloat64);
  torch::Tensor steps = torch::empty({count, 2}, torch::kInt64);  // of the episode, of all
  if (load) {
    numbers.copy_(state_tensor(state, "episodes", numbers));
    steps.copy_(state_tensor(state, "steps", steps));
    if (!state.facts.contains("random") || state.facts.at("random").size() != slots_.size()) {
      throw common::CheckpointError("state of the environments: random streams are missing");
    }
  } else {
    state.facts["random"] = common::Json::array();
  }
  double* number = numbers.data_ptr<double>();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    std::int64_t* step = steps.data_ptr<std::int64_t>() + 2 * i;
    double heading_rad = slot.seen.target_heading_rad.value_or(0.0);
    visit_numbers(slot.pose, slot.seen, heading_rad, [&](double& value) {
      if (load) {
        value = *number++;
      } else {
        *number++ = value;
      }
    });
    if (load) {
      if (settings_.task.goal == "pose") slot.seen.target_heading_rad = heading_rad;
      slot.step = step[0];
      slot.age = step[1];
      slot.random.restore(state.facts.at("random").at(i).get<std::string>());
      encoder_.encode(slot.seen,
                      result_.observation.data_ptr<float>() + static_cast<std::int64_t>(i) * columns_);
    } else {
      step[0] = slot.step;
      step[1] = slot.age;
      state.facts["random"].push_back(slot.random.save());
    }
  }
  if (load) return;
  state.tensors["episodes"] = numbers;
  state.tensors["steps"] = steps;
}

}  // namespace lodestone::env
