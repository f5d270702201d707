#include "lodestone/control/reference.h"

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
  return path_.at(config_.speed_m_s * (time_s - started_s_));
}

bool PathReference::finished(double time_s) const {
  // Half a microsecond of slack, as times are sums of periods.
  return !approaching() && time_s - started_s_ >= duration_s() - 5e-7;
}

}  // namespace lodestone::control
