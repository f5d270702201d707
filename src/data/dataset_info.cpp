#include "lodestone/data/dataset_info.h"

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"
#include "lodestone/geometry/drive.h"

namespace lodestone::data {

int state_size(StateLayout layout) { return layout == StateLayout::kPose ? 3 : 2; }

std::string action_column(int index, int action_size) {
  return "drive_" + geometry::number_name(index, action_size);
}

common::Json info_to_json(const DatasetInfo& info) {
  return {{"layout", common::name_of(info.layout)},
          {"action_size", info.action_size},
          {"action_unit", info.action_unit},
          {"action_scale", info.action_scale},
          {"workspace_radius_m", info.workspace_radius_m},
          {"one_axis_at_a_time", info.one_axis_at_a_time},
          {"control_period_s", info.control_period_s},
          {"seed", info.seed},
          {"source", info.source},
          {"rig", info.rig}};
}

DatasetInfo info_from_json(const common::Json& json, const std::string& source) {
  DatasetInfo info;
  try {
    const auto layout = json.at("layout").get<std::string>();
    const auto named = common::find_named<StateLayout>(layout);
    if (!named)
      throw common::DataError(source + ": layout \"" + common::shown(layout) + "\" must be pose or position");
    info.layout = *named;
    const auto numbers = json.value("action_size", std::int64_t{info.action_size});
    if (numbers < 1 || numbers > geometry::kMostDrives)
      throw common::DataError(source + ": action_size is " + std::to_string(numbers) +
                              ", must be within 1 and " + std::to_string(geometry::kMostDrives));
    info.action_size = static_cast<int>(numbers);
    json.at("action_unit").get_to(info.action_unit);
    json.at("action_scale").get_to(info.action_scale);
    json.at("workspace_radius_m").get_to(info.workspace_radius_m);
    json.at("one_axis_at_a_time").get_to(info.one_axis_at_a_time);
    json.at("control_period_s").get_to(info.control_period_s);
    json.at("seed").get_to(info.seed);
    json.at("source").get_to(info.source);
    info.rig = json.at("rig");
  } catch (const common::Json::exception& error) {
    throw common::DataError(source + ": what it says of its recording is malformed: " + error.what());
  }
  return info;
}

}  // namespace lodestone::data
