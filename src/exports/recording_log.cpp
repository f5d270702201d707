#include "lodestone/exports/recording_log.h"

#include <cmath>
#include <string>

#include "lodestone/physics/coil_drive.h"

namespace lodestone::exports {
namespace {

constexpr std::uint64_t kBetween_ns = 1'000'000'000;  // two episodes

LoggedStep logged(const data::DatasetInfo& info, const data::Episode& episode, std::int64_t row) {
  LoggedStep step;
  const int width = data::state_size(info.layout);
  const double* state = &episode.observations[static_cast<std::size_t>(row * width)];
  step.sensed = geometry::Pose2{state[0], state[1], width > 2 ? state[2] : 0.0};
  step.facts.sensed = true;
  if (row == episode.length()) return step;  // nothing was done after the last
  const geometry::Drive drive = geometry::as_drive(
      &episode.actions[static_cast<std::size_t>(row * info.action_size)], info.action_size);
  for (const double number : drive) step.facts.action.push_back(number / info.action_scale);
  const common::Json driven_by =
      info.rig.is_object() ? info.rig.value("drive", common::Json()) : common::Json();
  const bool pairs = info.action_size == 2 &&
                     (!driven_by.is_object() || driven_by.value("kind", "opposed_pairs") == "opposed_pairs");
  if (info.action_unit == "A" && pairs) {  // what else a drive asks of its coils is not on record
    step.current_A = physics::opposed_pairs_A(drive).list();
  }
  return step;
}

}  // namespace

std::int64_t log_recording(const data::Dataset& dataset, RigLog& log) {
  const auto period_ns = static_cast<std::uint64_t>(std::llround(1e9 * dataset.info.control_period_s));
  std::uint64_t now_ns = 0;
  std::int64_t steps = 0;
  for (std::size_t e = 0; e < dataset.episodes.size(); ++e) {
    const data::Episode& episode = dataset.episodes[e];
    if (e > 0) now_ns += kBetween_ns;
    log.event(now_ns, LogLevel::kInfo,
              "episode " + std::to_string(e) + (episode.placements > 0 ? ", placed by the operator" : ""));
    for (std::int64_t row = 0; row <= episode.length(); ++row, ++steps) {
      if (row > 0) now_ns += period_ns;
      LoggedStep step = logged(dataset.info, episode, row);
      step.time_ns = now_ns;
      log.step(step);
    }
  }
  return steps;
}

}  // namespace lodestone::exports
