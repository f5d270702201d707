#include "lodestone/data/dataset_info.h"

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/common/shown.h"

namespace lodestone::data {

int state_size(StateLayout layout) { return layout == StateLayout::kPose ? 3 : 2; }

common::Json info_to_json(const DatasetInfo& info) {
  return {{"layout", common::name_of(info.layout)},
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
