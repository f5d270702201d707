#include "lodestone/control/reference.h"

#include <algorithm>

namespace lodestone::control {

double PathReference::duration_s() const {
  const double length_m = path_.length_m() * (path_.closed() ? static_cast<double>(config_.laps) : 1.0);
  return length_m / config_.speed_m_s;
}

geometry::Vector2 PathReference::target(double time_s, const geometry::Vector2& position_m) {
  const geometry::Vector2 start_m = path_.at(0.0);
  if (approaching() &&
      ((position_m - start_m).norm() <= config_.approach_radius_m || time_s >= config_.approach_limit_s))
    started_s_ = time_s;
  if (approaching()) return start_m;
  return moving_target(time_s);
}

geometry::Vector2 PathReference::moving_target(double time_s) const {
  return path_.at(config_.speed_m_s * (time_s - started_s_));
}

std::vector<task::TargetAhead> PathReference::ahead(double time_s, double step_s, int count) const {
  if (approaching()) return {};
  std::vector<task::TargetAhead> points;
  for (int step = 1; step <= count; ++step) {
    const double in_s = step_s * step;
    points.push_back({moving_target(std::min(time_s + in_s, started_s_ + duration_s())), in_s});
  }
  return points;
}

bool PathReference::finished(double time_s) const {
  // Half a microsecond of slack, as times are sums of periods.
  return !approaching() && time_s - started_s_ >= duration_s() - 5e-7;
}

}  // namespace lodestone::control
