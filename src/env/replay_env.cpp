#include "lodestone/env/replay_env.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::env {

void ReplayConfig::validate() const {
  if (shortest > longest)
    throw common::InvalidConfig("shortest", shortest, fmt::format("not exceed longest = {}", longest));
}

ReplayEnv::ReplayEnv(const data::Dataset& dataset, const EpisodeSettings& settings,
                     const ReplayConfig& config)
    : config_(config),
      action_scale_(dataset.info.action_scale),
      action_size_(static_cast<std::size_t>(dataset.info.action_size)),
      state_size_(static_cast<std::size_t>(data::state_size(dataset.info.layout))),
      episodes_(settings, {}, "replay"),
      stretches_(static_cast<std::size_t>(settings.count)) {
  config.validate();
  if (settings.action.size != dataset.info.action_size)
    throw common::ConfigError("recorded: its actions are of " + std::to_string(dataset.info.action_size) +
                              " numbers, those of the simulator of " + std::to_string(settings.action.size));
  for (const data::Episode& episode : dataset.episodes) {
    if (config.keep_shorter || episode.length() >= config.shortest) recorded_.push_back(episode);
  }
  if (recorded_.empty())
    throw common::ConfigError("replay.shortest = " + std::to_string(config.shortest) +
                              ": no recorded episode is that long");
  if (state_size_ == 2 && settings.encoder.heading != task::HeadingEncoding::kNone)
    throw common::ConfigError("encoder.heading = \"" + common::name_of(settings.encoder.heading) +
                              "\", but the recording has no heading; set it to \"none\"");
  reset();
}

geometry::Pose2 ReplayEnv::pose(std::int64_t episode, std::int64_t step) const {
  const double* row = &recorded_[static_cast<std::size_t>(episode)]
                           .observations[static_cast<std::size_t>(step) * state_size_];
  return {row[0], row[1], state_size_ == 3 ? row[2] : 0.0};
}

void ReplayEnv::begin(std::size_t i) {
  episodes_.begin(i, [&](common::RandomStream& random) {
    Stretch& stretch = stretches_[i];
    stretch.episode = static_cast<std::int64_t>(random.below(recorded_.size()));
    const std::int64_t length = recorded_[static_cast<std::size_t>(stretch.episode)].length();
    const auto up_to = [&random](std::int64_t most) {
      return static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(most) + 1));
    };
    const std::int64_t steps = std::min(length, config_.shortest + up_to(config_.longest - config_.shortest));
    stretch.next = up_to(length - steps);
    stretch.end = stretch.next + steps;
    return pose(stretch.episode, stretch.next);
  });
}

const std::vector<float>& ReplayEnv::reset() {
  for (std::size_t i = 0; i < stretches_.size(); ++i) begin(i);
  return episodes_.observation();
}

const StepResult& ReplayEnv::step(const std::vector<float>& actions) {
  episodes_.check_actions(actions);
  std::vector<float> done(action_size_ * stretches_.size());
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    Stretch& stretch = stretches_[i];
    const data::Episode& episode = recorded_[static_cast<std::size_t>(stretch.episode)];
    const double* drive = &episode.actions[action_size_ * static_cast<std::size_t>(stretch.next)];
    const geometry::Drive action =
        geometry::saturated(geometry::as_drive(drive, episodes_.settings().action.size) / action_scale_);
    episodes_.note_action(i, action);
    std::copy(action.begin(), action.end(), &done[action_size_ * i]);
    ++stretch.next;
    StepEnd extra;
    extra.truncated = stretch.next == stretch.end;
    if (episodes_.finish(i, pose(stretch.episode, stretch.next), extra)) begin(i);
  }
  result_ = episodes_.result();
  result_.action = std::move(done);
  return result_;
}

Snapshot ReplayEnv::save() const {
  Snapshot snapshot = episodes_.save();
  std::vector<std::int64_t> numbers;
  for (const Stretch& stretch : stretches_)
    numbers.insert(numbers.end(), {stretch.episode, stretch.next, stretch.end});
  snapshot.arrays["stretches"] = {std::move(numbers), {episodes_.spec().count, 3}};
  return snapshot;
}

void ReplayEnv::load(const Snapshot& snapshot) {
  episodes_.load(snapshot);
  const auto* number = snapshot_numbers<std::int64_t>(snapshot, "stretches", {episodes_.spec().count, 3});
  for (Stretch& stretch : stretches_) {
    for (std::int64_t* value : {&stretch.episode, &stretch.next, &stretch.end}) *value = *number++;
    const bool known = stretch.episode >= 0 && stretch.episode < static_cast<std::int64_t>(recorded_.size());
    if (!known || stretch.next < 0 || stretch.next >= stretch.end ||
        stretch.end > recorded_[static_cast<std::size_t>(stretch.episode)].length())
      throw common::CheckpointError("state of the environments names steps that the recording does not have");
  }
}

}  // namespace lodestone::env
