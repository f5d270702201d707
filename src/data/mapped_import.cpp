#include "lodestone/data/mapped_import.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "import_rows.h"
#include "lodestone/common/error.h"

namespace lodestone::data {
namespace {

/// Drives that differ by less than this part of the largest one are the same, measured as they are.
constexpr double kSameDrive = 0.05;

CuttingRule rule_of(const CsvImportConfig& config, const MapConfig& map, const MappedLog& log) {
  CuttingRule rule;
  rule.period_s = config.control_period_s;
  rule.on_s = map.pulse_s;
  rule.tolerance = map.tolerance;
  rule.longest_gap_s = map.longest_gap_s;
  rule.same_drive = kSameDrive * log.action_scale;
  return rule;
}

template <std::size_t S>
std::array<double, S> state_of(const geometry::Pose2& pose) {
  if constexpr (S == 3)
    return {pose.x_m, pose.y_m, pose.heading_rad};
  else
    return {pose.x_m, pose.y_m};
}

template <std::size_t S>
void record(const CutLog& cut, Recording& recording) {
  for (const CutPulse& pulse : cut.pulses) {
    if (!pulse.follows) {
      recording.cut();
      recording.observe(state_of<S>(pulse.before), pulse.line_before);
    }
    recording.act({pulse.drive.x(), pulse.drive.y()});
    recording.observe(state_of<S>(pulse.after), pulse.line_after);
  }
  recording.cut();
}

bool one_axis_at_a_time(const std::vector<CutPulse>& pulses) {
  return std::none_of(pulses.begin(), pulses.end(),
                      [](const CutPulse& pulse) { return pulse.drive.x() != 0.0 && pulse.drive.y() != 0.0; });
}

}  // namespace

MappedImport import_mapped(const std::string& path, const CsvImportConfig& config, const MapConfig& map) {
  MappedImport imported;
  CsvImportResult& result = imported.result;
  result.layout = "mapped";
  imported.log = read_mapped_log(path, config, map, result);
  if (config.plausible && !imported.log.samples.empty())
    check_sizes(sizes_of(imported.log, config.dish_radius_m), config.dish_radius_m, path);
  imported.cut = cut_pulses(imported.log.samples, rule_of(config, map, imported.log), path);

  DatasetInfo& info = result.dataset.info;
  info.layout = imported.log.heading ? StateLayout::kPose : StateLayout::kPosition;
  info.action_unit = imported.log.action_unit;
  info.action_scale = imported.log.action_scale;
  info.workspace_radius_m = config.dish_radius_m;
  info.one_axis_at_a_time = one_axis_at_a_time(imported.cut.pulses);
  info.control_period_s = imported.cut.period_s;
  info.seed = config.seed;
  info.source = path.substr(path.find_last_of('/') + 1);
  info.rig = config.rig;
  Recording recording(result.dataset);
  if (imported.log.heading)
    record<3>(imported.cut, recording);
  else
    record<2>(imported.cut, recording);
  if (config.impossible == Impossible::kLeaveOut)
    leave_out_impossible(result, recording, config.dish_radius_m, path,
                         "the unit of x and y, centre_x and centre_y, or the rig's dish");
  if (result.dataset.episodes.empty())
    throw common::DataError(path + ": no pulse is left of " + std::to_string(result.rows) +
                            " rows: give control_period_s, or widen map.tolerance or map.longest_gap_s");
  check_dataset(result.dataset, path);
  imported.directions = match_directions(result.dataset);
  if (config.plausible) check_directions(result.dataset, path);
  return imported;
}

}  // namespace lodestone::data
