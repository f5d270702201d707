#include "lodestone/task/action.h"

#include <cmath>

#include "lodestone/geometry/saturation.h"

namespace lodestone::task {
namespace {

constexpr double kLargestScale = 1e3;  // A or percent

}  // namespace

common::Json action_to_json(const ActionConfig& config) {
  common::Json json = common::config_to_json(config);
  json["scale"] = config.scale;
  json["unit"] = config.unit;
  return json;
}

ActionConfig action_from_json(common::Json json, const std::string& what) {
  const double scale = json.at("scale").get<double>();
  const std::string unit = json.value("unit", "A");
  if (!(scale > 0.0 && scale <= kLargestScale))
    throw common::ConfigError(what + ": scale = " + common::shown_json(json["scale"]) +
                              " must be above 0 and at most 1000");
  json.erase("scale");
  json.erase("unit");
  auto config = common::config_from_json<ActionConfig>(json, what);
  config.scale = scale;
  config.unit = unit;
  return config;
}

geometry::Vector2 axis_drive(const geometry::Vector2& action, const ActionConfig& config) {
  geometry::Vector2 drive = geometry::saturated(action);
  drive *= drive.norm() < config.dead_band ? 0.0 : config.scale;
  if (config.one_axis_at_a_time) drive[std::abs(drive[0]) >= std::abs(drive[1]) ? 1 : 0] = 0.0;
  return drive;
}

}  // namespace lodestone::task
