#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::data {

/// What one observation row holds.
enum class StateLayout {
  kPosition,  ///< x_m, y_m (a sphere: the recorded pulses)
  kPose,      ///< x_m, y_m, heading_rad (a needle)
};
inline std::vector<std::string> names_of(StateLayout) { return {"position", "pose"}; }

/// 2 or 3 numbers a row.
int state_size(StateLayout layout);

/// What the rows of a transition hold.
struct RowLayout {
  StateLayout state = StateLayout::kPose;
  int action_size = 2;  ///< numbers of an action

  RowLayout(StateLayout state_layout, int numbers = 2) : state(state_layout), action_size(numbers) {}
};

/// What the numbers of an action are called: drive_x and drive_y where there are two, else drive_0, drive_1,
/// ...
std::string action_column(int index, int action_size);

/// Where a dataset comes from and what its numbers mean; stored as attributes.
struct DatasetInfo {
  StateLayout layout = StateLayout::kPose;
  int action_size = 2;              ///< numbers of an action, 1 to 16
  std::string action_unit = "A";    ///< "A" or "percent"
  double action_scale = 15.0;       ///< action that [-1, 1] maps to: the largest current or drive
  double workspace_radius_m = 0.0;  ///< reach of the state: the dish radius, or the radius the data covers
  bool one_axis_at_a_time = false;  ///< true when no row ever drives both axes (the recorded sphere)
  double control_period_s = 0.3;
  std::int64_t seed = 0;
  std::string source;                         ///< "virtual rig", or the imported file's name
  common::Json rig = common::Json::object();  ///< parameters of the rig as configured

  RowLayout rows() const { return {layout, action_size}; }
};

/// As the files hold it: the keys are the members' names. Files from before there were other drives do not
/// give action_size; they mean 2.
common::Json info_to_json(const DatasetInfo& info);
/// Throws DataError that begins with `source` when a key is missing or of another type.
DatasetInfo info_from_json(const common::Json& json, const std::string& source);

}  // namespace lodestone::data
