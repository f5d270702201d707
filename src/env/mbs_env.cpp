#include "lodestone/env/mbs_env.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::env {
namespace {

/// Fixed, so that results do not depend on the number of threads; its activations fit a core's cache.
constexpr std::size_t kShardRows = 512;
/// What is left of the gain's uncertainty once a rig is known.
constexpr double kLeastGainSigma = 0.03;

}  // namespace

std::vector<geometry::Pose2> starts_within(const inference::DynamicsModel& model, double radius_m,
                                           const task::Region* region) {
  const std::vector<double>& states = model.start_states;
  const auto size = static_cast<std::size_t>(data::state_size(model.info.layout));
  std::vector<geometry::Pose2> starts;
  for (std::size_t i = 0; i + size <= states.size(); i += size) {
    const geometry::Pose2 pose{states[i], states[i + 1], size == 3 ? states[i + 2] : 0.0};
    if (pose.position_m().norm() <= radius_m && (region == nullptr || region->contains(pose.position_m())))
      starts.push_back(pose);
  }
  if (starts.empty()) {
    throw common::ConfigError("task.start_radius: " + std::to_string(radius_m) +
                              " m holds no state of the training data; choose a larger one");
  }
  return starts;
}

MbsEnv::MbsEnv(const inference::DynamicsModel& model, const EpisodeSettings& settings,
               const MbsConfig& config, std::int64_t threads)
    : config_(config),
      mean_of_all_(config.ensemble == EnsembleUse::kMean && model.members.size() > 1),
      sample_(config.outcome == Outcome::kSample),
      disagreement_(config.disagreement_penalty > 0.0 || config.disagreement_stop_m > 0.0),
      members_(model.members),
      state_size_(static_cast<std::size_t>(data::state_size(model.info.layout))),
      action_size_(static_cast<std::size_t>(model.info.action_size)),
      starts_(starts_within(model, settings.task.start_radius_m(), settings.region.get())),
      episodes_(settings, {config.pose_noise_m, config.heading_noise_rad}, "mbs"),
      member_(static_cast<std::size_t>(settings.count), 0),
      drive_factor_(static_cast<std::size_t>(settings.count), 1.0),
      pool_(static_cast<std::size_t>(threads)) {
  LODESTONE_CHECK(!members_.empty(), "the ensemble has no member");
  LODESTONE_CHECK(settings.action.size == model.info.action_size, "actions of the model's size");
  if (state_size_ == 2 && settings.encoder.heading != task::HeadingEncoding::kNone) {
    throw common::ConfigError("encoder.heading = \"" + common::name_of(settings.encoder.heading) +
                              "\", but the model's state has no heading; set it to \"none\"");
  }
  if (sample_ && model.config.components == 0)
    throw common::ConfigError(
        "mbs.outcome = \"sample\", but the dynamics predict single values; train them with "
        "model.components of 1 or more");
  if (sample_ && mean_of_all_)
    throw common::ConfigError(
        "mbs.outcome = \"sample\" needs one member at a time: set mbs.ensemble to per_episode or "
        "per_step");
  if (disagreement_ && members_.size() < 2)
    throw common::ConfigError(
        "mbs.disagreement_penalty and disagreement_stop_m need an ensemble; train the dynamics "
        "with model.members of 2 or more");
  reset();
}

std::size_t MbsEnv::shards() const { return (member_.size() + kShardRows - 1) / kShardRows; }

void MbsEnv::begin(std::size_t i) {
  common::RandomStream& random = episodes_.random(i);
  std::optional<task::DriveGain> told;
  if (episodes_.settings().encoder.drive_gain)
    told = task::draw_gain_estimate(config_.breakaway_scatter, kLeastGainSigma, random);
  episodes_.begin(
      i, [this](common::RandomStream& stream) { return starts_[stream.below(starts_.size())]; }, told);
  if (config_.ensemble == EnsembleUse::kPerEpisode)
    member_[i] = static_cast<std::int64_t>(random.below(members_.size()));
  if (config_.breakaway_scatter > 0.0) {
    const task::DriveGain known = told.value_or(task::DriveGain{0.0, config_.breakaway_scatter});
    drive_factor_[i] = std::exp(known.log_mean + known.log_sigma * random.normal());
    // The simulator knows no drive beyond its limit: a stronger rig would be one that loses its top.
    if (!told) drive_factor_[i] = std::min(1.0, drive_factor_[i]);
  }
}

const std::vector<float>& MbsEnv::reset() {
  pool_.for_each(shards(), [this](std::size_t shard) {
    const std::size_t last = std::min(member_.size(), (shard + 1) * kShardRows);
    for (std::size_t i = shard * kShardRows; i < last; ++i) begin(i);
  });
  return episodes_.observation();
}

const StepResult& MbsEnv::step(const std::vector<float>& actions) {
  episodes_.check_actions(actions);
  const float* values = actions.data();
  pool_.for_each(shards(), [this, values](std::size_t shard) { step_shard(shard, values); });
  return episodes_.result();
}

void MbsEnv::step_shard(std::size_t shard, const float* actions) {
  const std::size_t first = shard * kShardRows;
  const std::size_t last = std::min(member_.size(), first + kShardRows);
  std::unique_ptr<Scratch> scratch = borrow_scratch();
  choose_drives(first, last, actions, *scratch);
  gather(first, last, *scratch);
  if (mean_of_all_) {
    inference::predict_mean(members_, scratch->state.data(), scratch->gathered_drive.data(),
                            static_cast<std::int64_t>(scratch->gathered_drive.size() / action_size_),
                            scratch->next.data(), scratch->one_member, scratch->workspace);
  } else {
    predict(*scratch);
  }
  if (disagreement_) measure_disagreement(*scratch);
  // Rows that do not move come first in `row`, see gather().
  for (std::size_t k = 0; k < scratch->row.size(); ++k) {
    const std::size_t i = scratch->row[k];
    geometry::Pose2 next = episodes_.pose(i);
    StepEnd extra;
    if (k >= scratch->first_of_member.front()) {
      const double* state = &scratch->next[(k - scratch->first_of_member.front()) * state_size_];
      next = {state[0], state[1], state_size_ == 3 ? state[2] : 0.0};
      if (disagreement_) {
        const double apart_m = scratch->disagreement_m[k - scratch->first_of_member.front()];
        extra.penalty = config_.disagreement_penalty * apart_m / episodes_.settings().task.dish_radius_m;
        extra.terminated = config_.disagreement_stop_m > 0.0 && apart_m > config_.disagreement_stop_m;
      }
    }
    if (episodes_.finish(i, next, extra)) begin(i);
  }
  give_back(std::move(scratch));
}

void MbsEnv::choose_drives(std::size_t first, std::size_t last, const float* actions, Scratch& scratch) {
  const double limit = episodes_.settings().action.scale;
  scratch.drive.resize(action_size_ * (last - first));
  for (std::size_t i = first; i < last; ++i) {
    geometry::Drive drive = episodes_.drive(i, actions + action_size_ * i);
    if (config_.breakaway_scatter > 0.0)  // the limit is what planner and gain filter take more for, too
      drive = geometry::saturated(drive * drive_factor_[i], limit);
    common::RandomStream& random = episodes_.random(i);
    if (config_.stall_probability > 0.0 && random.uniform() < config_.stall_probability) drive.setZero();
    if (config_.ensemble == EnsembleUse::kPerStep)
      member_[i] = static_cast<std::int64_t>(random.below(members_.size()));
    std::copy_n(drive.data(), action_size_, &scratch.drive[action_size_ * (i - first)]);
  }
}

/// Orders the shard's rows: those at rest, then those of member 0, 1, ... (a counting sort), and copies state
/// and drive of the moving ones together. first_of_member[m] is where member m begins in `row`.
void MbsEnv::gather(std::size_t first, std::size_t last, Scratch& scratch) const {
  const bool mean = mean_of_all_;
  const std::size_t groups = mean ? 1 : members_.size();
  const bool rest_rule =
      episodes_.settings().task.zero_current_moves_nothing || config_.stall_probability > 0.0;
  const auto group_of = [&](std::size_t i) -> std::size_t {
    const double* drive = &scratch.drive[action_size_ * (i - first)];
    const auto is_zero = [](double number) { return number == 0.0; };
    if (rest_rule && std::all_of(drive, drive + action_size_, is_zero)) return 0;
    return mean ? 1 : 1 + static_cast<std::size_t>(member_[i]);
  };
  std::vector<std::size_t>& start = scratch.first_of_member;
  start.assign(groups + 2, 0);  // shifted by one while counting
  for (std::size_t i = first; i < last; ++i) ++start[group_of(i) + 1];
  for (std::size_t group = 1; group < start.size(); ++group) start[group] += start[group - 1];
  const std::size_t resting = start[1];
  const std::size_t moving = last - first - resting;
  scratch.row.resize(last - first);
  scratch.state.resize(moving * state_size_);
  scratch.next.resize(moving * state_size_);
  scratch.gathered_drive.resize(action_size_ * moving);
  for (std::size_t i = first; i < last; ++i) {
    const std::size_t place = start[group_of(i)]++;
    scratch.row[place] = i;
    if (place < resting) continue;
    const geometry::Pose2& pose = episodes_.pose(i);
    double* state = &scratch.state[(place - resting) * state_size_];
    state[0] = pose.x_m;
    state[1] = pose.y_m;
    if (state_size_ == 3) state[2] = pose.heading_rad;
    std::copy_n(&scratch.drive[action_size_ * (i - first)], action_size_,
                &scratch.gathered_drive[action_size_ * (place - resting)]);
  }
  // Each start has moved on to its group's end: entry g is now where group g + 1 begins.
}

void MbsEnv::predict(Scratch& scratch) {
  const std::size_t resting = scratch.first_of_member.front();
  scratch.random.clear();
  for (std::size_t k = resting; sample_ && k < scratch.row.size(); ++k)
    scratch.random.push_back(&episodes_.random(scratch.row[k]));
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const std::size_t begin = scratch.first_of_member[m] - resting;
    const std::size_t rows = scratch.first_of_member[m + 1] - resting - begin;
    if (rows == 0) continue;
    const double* state = &scratch.state[begin * state_size_];
    const double* drive = &scratch.gathered_drive[action_size_ * begin];
    double* next = &scratch.next[begin * state_size_];
    if (sample_) {
      members_[m].sample(state, drive, static_cast<std::int64_t>(rows), &scratch.random[begin], next,
                         scratch.workspace);
    } else {
      members_[m].predict(state, drive, static_cast<std::int64_t>(rows), next, scratch.workspace);
    }
  }
}

/// Root mean square distance of the members' expected positions from their mean.
void MbsEnv::measure_disagreement(Scratch& scratch) const {
  const std::size_t rows = scratch.gathered_drive.size() / action_size_;
  scratch.disagreement_m.assign(rows, 0.0);
  if (rows == 0) return;
  scratch.mean_position.assign(2 * rows, 0.0);
  scratch.one_member.resize(rows * state_size_);
  for (const inference::FoldedDynamics& member : members_) {
    member.predict(scratch.state.data(), scratch.gathered_drive.data(), static_cast<std::int64_t>(rows),
                   scratch.one_member.data(), scratch.workspace);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double value = scratch.one_member[row * state_size_ + axis];
        scratch.mean_position[2 * row + axis] += value;
        scratch.disagreement_m[row] += value * value;
      }
    }
  }
  const auto count = static_cast<double>(members_.size());
  for (std::size_t row = 0; row < rows; ++row) {
    const double x = scratch.mean_position[2 * row] / count;
    const double y = scratch.mean_position[2 * row + 1] / count;
    scratch.disagreement_m[row] =
        std::sqrt(std::max(0.0, scratch.disagreement_m[row] / count - x * x - y * y));
  }
}

std::unique_ptr<MbsEnv::Scratch> MbsEnv::borrow_scratch() {
  const std::lock_guard<std::mutex> lock(scratch_mutex_);
  if (scratch_.empty()) return std::make_unique<Scratch>();
  std::unique_ptr<Scratch> scratch = std::move(scratch_.back());
  scratch_.pop_back();
  return scratch;
}

void MbsEnv::give_back(std::unique_ptr<Scratch> scratch) {
  const std::lock_guard<std::mutex> lock(scratch_mutex_);
  scratch_.push_back(std::move(scratch));
}

Snapshot MbsEnv::save() const {
  Snapshot snapshot = episodes_.save();
  snapshot.arrays["member"] = {member_, {episodes_.spec().count}};
  snapshot.arrays["drive_factor"] = {drive_factor_, {episodes_.spec().count}};
  return snapshot;
}

void MbsEnv::load(const Snapshot& snapshot) {
  episodes_.load(snapshot);
  std::copy_n(snapshot_numbers<std::int64_t>(snapshot, "member", {episodes_.spec().count}), member_.size(),
              member_.begin());
  std::copy_n(snapshot_numbers<double>(snapshot, "drive_factor", {episodes_.spec().count}),
              drive_factor_.size(), drive_factor_.begin());
  for (const std::int64_t k : member_) {
    if (k < 0 || k >= static_cast<std::int64_t>(members_.size())) {
      throw common::CheckpointError("state of the environments names member " + std::to_string(k) +
                                    " of an ensemble of " + std::to_string(members_.size()));
    }
  }
}

}  // namespace lodestone::env
