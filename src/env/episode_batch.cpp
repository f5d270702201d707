#include "lodestone/env/episode_batch.h"

#include <algorithm>

#include "lodestone/common/error.h"
#include "lodestone/geometry/saturation.h"
#include "lodestone/task/without_heading.h"

namespace lodestone::env {
namespace {

constexpr int kStartTries = 16;
constexpr std::int64_t kSlotNumbers = 13;  // and those of an action

/// The numbers of a slot that outlive a step, in the order checkpoints hold them.
template <class Pose, class Observation, class Number, class Gain, class Visit>
void visit_numbers(Pose& pose, Observation& seen, Number& target_heading_rad, Gain& gain, Visit&& visit) {
  for (auto* value : {&pose.x_m, &pose.y_m, &pose.heading_rad, &seen.pose.x_m, &seen.pose.y_m,
                      &seen.pose.heading_rad, &seen.target_m.x(), &seen.target_m.y(), &target_heading_rad})
    visit(*value);
  for (Eigen::Index i = 0; i < seen.last_action.size(); ++i) visit(seen.last_action[i]);
  for (auto* value :
       {&seen.last_displacement_m.x(), &seen.last_displacement_m.y(), &gain.log_mean, &gain.log_sigma})
    visit(*value);
}

}  // namespace

void adopt_data(const data::DatasetInfo& info, task::TaskConfig& task, task::EncoderConfig& encoder,
                task::ActionConfig& action) {
  action.scale = info.action_scale;
  action.unit = info.action_unit;
  action.one_axis_at_a_time = info.one_axis_at_a_time;
  action.size = info.action_size;
  encoder.action_size = info.action_size;
  task.dish_radius_m = info.workspace_radius_m;
  encoder.length_scale_m = info.workspace_radius_m;
  if (info.layout != data::StateLayout::kPose)
    task::leave_out_heading(task, encoder, "what the simulator was learned from");
}

void adopt_rig(const physics::RigDescription& rig, task::TaskConfig& task, task::EncoderConfig& encoder,
               task::ActionConfig& action) {
  action.scale = rig.coils.max_current_A;
  action.size = encoder.action_size = rig.drive_size();
  task.dish_radius_m = encoder.length_scale_m = rig.dish.radius_m;
  if (rig.needle.is_sphere()) task::leave_out_heading(task, encoder, "a sphere");
}

EpisodeBatch::EpisodeBatch(const EpisodeSettings& settings, const SensorNoise& noise, const std::string& name)
    : settings_(settings),
      noise_(noise),
      encoder_(settings.encoder),
      columns_(static_cast<std::size_t>(encoder_.size())) {
  if (settings.count < 1) {
    throw common::ConfigError("the number of environments must be at least 1, not " +
                              std::to_string(settings.count));
  }
  slots_.reserve(static_cast<std::size_t>(settings.count));
  for (std::int64_t i = 0; i < settings.count; ++i)
    slots_.emplace_back(
        common::RandomStream(settings.seed, name, settings.first_stream + static_cast<std::uint64_t>(i)));
  result_.observation.resize(slots_.size() * columns_);
  result_.final_observation.resize(slots_.size() * columns_);
  result_.reward.resize(slots_.size());
  result_.terminated.resize(slots_.size());
  result_.truncated.resize(slots_.size());
  result_.success.resize(slots_.size());
  result_.penalty.resize(slots_.size());
  result_.progress.resize(slots_.size(), 1.0);
}

EnvSpec EpisodeBatch::spec() const { return {settings_.count, encoder_.size(), settings_.action.size}; }

void EpisodeBatch::check_actions(const std::vector<float>& actions) const {
  const auto size = static_cast<std::size_t>(settings_.action.size);
  LODESTONE_CHECK(actions.size() == size * slots_.size(),
                  std::to_string(size) + " numbers of action for each of " + std::to_string(slots_.size()) +
                      " environments, not " + std::to_string(actions.size()) + " in all");
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

double EpisodeBatch::progress(const Slot& slot) const {
  if (settings_.shrink_steps <= 0) return 1.0;
  return static_cast<double>(slot.age) / static_cast<double>(settings_.shrink_steps);
}

void EpisodeBatch::begin(std::size_t i,
                         const std::function<geometry::Pose2(common::RandomStream&)>& draw_start,
                         const std::optional<task::DriveGain>& gain) {
  Slot& slot = slots_[i];
  const task::TaskConfig& task = settings_.task;
  slot.seen = {};
  slot.seen.last_action.setZero(settings_.action.size);
  slot.seen.drive_gain = gain;
  slot.step = 0;
  for (int attempt = 0; attempt < kStartTries; ++attempt) {
    slot.pose = draw_start(slot.random);
    const task::Goal goal = task::draw_goal(task, slot.random, settings_.region.get());
    slot.seen.target_m = goal.position_m;
    slot.seen.target_heading_rad = goal.heading_rad;
    if (!task.end_on_success || !task::reached(task, slot.pose, goal, progress(slot))) break;
  }
  slot.seen.pose = sense(slot);
  encoder_.encode(slot.seen, &result_.observation[i * columns_]);
}

geometry::Drive EpisodeBatch::drive(std::size_t i, const float* action) {
  const geometry::Drive wanted = geometry::saturated(geometry::as_drive(action, settings_.action.size));
  slots_[i].seen.last_action = wanted;
  return task::drive_of(wanted, settings_.action);
}

bool EpisodeBatch::finish(std::size_t i, const geometry::Pose2& next, const StepEnd& extra) {
  Slot& slot = slots_[i];
  ++slot.step;
  ++slot.age;
  task::Step step;
  step.before = slot.pose;
  step.after = next;
  step.goal = {slot.seen.target_m, slot.seen.target_heading_rad};
  step.action = slot.seen.last_action;
  step.index = slot.step;
  step.progress = progress(slot);
  task::StepOutcome outcome = task::evaluate_step(settings_.task, step);
  outcome.reward -= extra.penalty;
  outcome.terminated = outcome.terminated || extra.terminated;
  outcome.truncated = !outcome.terminated && (outcome.truncated || extra.truncated);
  slot.pose = next;
  const geometry::Vector2 before_m = slot.seen.pose.position_m();
  slot.seen.pose = sense(slot);
  slot.seen.last_displacement_m = slot.seen.pose.position_m() - before_m;

  result_.reward[i] = static_cast<float>(outcome.reward);
  result_.terminated[i] = outcome.terminated ? 1 : 0;
  result_.truncated[i] = outcome.truncated ? 1 : 0;
  result_.success[i] = outcome.success ? 1 : 0;
  result_.penalty[i] = extra.penalty;
  result_.progress[i] = step.progress;
  float* final_row = &result_.final_observation[i * columns_];
  encoder_.encode(slot.seen, final_row);
  if (outcome.terminated || outcome.truncated) return true;
  std::copy_n(final_row, columns_, &result_.observation[i * columns_]);
  return false;
}

std::int64_t EpisodeBatch::slot_numbers() const { return kSlotNumbers + settings_.action.size; }

Snapshot EpisodeBatch::save() const {
  Snapshot snapshot;
  snapshot.facts["random"] = common::Json::array();
  std::vector<double> numbers;
  std::vector<std::int64_t> steps;  // of the episode, of all
  for (const Slot& slot : slots_) {
    const double heading_rad = slot.seen.target_heading_rad.value_or(0.0);
    const task::DriveGain gain = slot.seen.drive_gain.value_or(task::DriveGain{});
    visit_numbers(slot.pose, slot.seen, heading_rad, gain, [&](double value) { numbers.push_back(value); });
    steps.insert(steps.end(), {slot.step, slot.age});
    snapshot.facts["random"].push_back(slot.random.save());
  }
  snapshot.arrays["episodes"] = {std::move(numbers), {settings_.count, slot_numbers()}};
  snapshot.arrays["steps"] = {std::move(steps), {settings_.count, 2}};
  return snapshot;
}

void EpisodeBatch::load(const Snapshot& snapshot) {
  const auto* number = snapshot_numbers<double>(snapshot, "episodes", {settings_.count, slot_numbers()});
  const auto* step = snapshot_numbers<std::int64_t>(snapshot, "steps", {settings_.count, 2});
  if (!snapshot.facts.contains("random") || snapshot.facts.at("random").size() != slots_.size())
    throw common::CheckpointError("state of the environments: random streams are missing");
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    double heading_rad = 0.0;
    task::DriveGain gain;
    slot.seen.last_action.setZero(settings_.action.size);
    visit_numbers(slot.pose, slot.seen, heading_rad, gain, [&](double& value) { value = *number++; });
    if (settings_.encoder.drive_gain) slot.seen.drive_gain = gain;
    if (settings_.task.goal == task::GoalKind::kPose) slot.seen.target_heading_rad = heading_rad;
    slot.step = *step++;
    slot.age = *step++;
    slot.random.restore(snapshot.facts.at("random").at(i).get<std::string>());
    encoder_.encode(slot.seen, &result_.observation[i * columns_]);
  }
}

}  // namespace lodestone::env
