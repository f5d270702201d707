#include "lodestone/task/action.h"

#include <algorithm>
#include <cmath>

namespace lodestone::task {

geometry::Vector2 axis_drive(const geometry::Vector2& action, const ActionConfig& config) {
  geometry::Vector2 drive;
  for (int axis = 0; axis < 2; ++axis) {
    const double clipped = std::clamp(action[axis], -1.0, 1.0);
    drive[axis] = std::abs(clipped) < config.dead_band ? 0.0 : clipped * config.scale;
  }
  if (config.one_axis_at_a_time) drive[std::abs(drive[0]) >= std::abs(drive[1]) ? 1 : 0] = 0.0;
  return drive;
}

std::array<double, 4> coil_currents(const geometry::Vector2& axis_drive) {
  return {std::max(axis_drive.x(), 0.0), std::max(-axis_drive.x(), 0.0), std::max(axis_drive.y(), 0.0),
          std::max(-axis_drive.y(), 0.0)};
}

}  // namespace lodestone::task
