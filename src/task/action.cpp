#include "lodestone/task/action.h"

#include <cmath>
#include <cstdint>

#include "lodestone/geometry/saturation.h"

namespace lodestone::task {
namespace {

constexpr double kLargestScale = 1e3;  // A or percent

}  // namespace

common::Json action_to_json(const ActionConfig& config) {
  common::Json json = common::config_to_json(config);
  json["scale"] = config.scale;
  json["unit"] = config.unit;
  json["size"] = config.size;
  return json;
}

ActionConfig action_from_json(common::Json json, const std::string& what) {
  const double scale = json.at("scale").get<double>();
  const std::string unit = json.value("unit", "A");
  if (!(scale > 0.0 && scale <= kLargestScale))
    throw common::ConfigError(what + ": scale = " + common::shown_json(json["scale"]) +
                              " must be above 0 and at most 1000");
  const auto size = json.value("size", std::int64_t{ActionConfig{}.size});
  if (size < 1 || size > geometry::kMostDrives)
    throw common::ConfigError(what + ": size = " + common::shown_json(json["size"]) +
                              " must be within 1 .. 16");
  for (const char* key : {"scale", "unit", "size"}) json.erase(key);
  auto config = common::config_from_json<ActionConfig>(json, what);
  config.scale = scale;
  config.unit = unit;
  config.size = static_cast<int>(size);
  return config;
}

geometry::Drive drive_of(const geometry::Drive& action, const ActionConfig& config) {
  geometry::Drive drive = geometry::saturated(action);
  drive *= drive.norm() < config.dead_band ? 0.0 : config.scale;
  if (!config.one_axis_at_a_time) return drive;
  Eigen::Index largest = 0;
  drive.cwiseAbs().maxCoeff(&largest);
  for (Eigen::Index i = 0; i < drive.size(); ++i)
    if (i != largest) drive[i] = 0.0;
  return drive;
}

geometry::Drive draw_action(int size, double weakest, common::RandomStream& random) {
  const geometry::Drive direction = geometry::drawn_drive(size, [&random] { return random.normal(); });
  return direction * (std::pow(weakest, random.uniform()) / direction.cwiseAbs().maxCoeff());
}

geometry::Drive vary_action(const geometry::Drive& action, double share, common::RandomStream& random) {
  const geometry::Drive aside =
      geometry::drawn_drive(static_cast<int>(action.size()), [&random] { return random.normal(); });
  const double factor = std::exp(share * random.normal());
  return geometry::saturated(factor * action + share * action.norm() * aside);
}

}  // namespace lodestone::task
