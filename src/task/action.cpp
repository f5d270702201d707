#include "lodestone/task/action.h"

#include <algorithm>
#include <cmath>

#include "lodestone/geometry/saturation.h"

namespace lodestone::task {

geometry::Vector2 axis_drive(const geometry::Vector2& action, const ActionConfig& config) {
  geometry::Vector2 drive = geometry::saturated(action);
  for (double& axis : drive) axis = std::abs(axis) < config.dead_band ? 0.0 : axis * config.scale;
  if (config.one_axis_at_a_time) drive[std::abs(drive[0]) >= std::abs(drive[1]) ? 1 : 0] = 0.0;
  return drive;
}

std::array<double, 4> coil_currents(const geometry::Vector2& axis_drive) {
  return {std::max(axis_drive.x(), 0.0), std::max(-axis_drive.x(), 0.0), std::max(axis_drive.y(), 0.0),
          std::max(-axis_drive.y(), 0.0)};
}

}  // namespace lodestone::task
