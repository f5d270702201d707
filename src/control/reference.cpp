#include "lodestone/control/reference.h"

#include <algorithm>

namespace lodestone::control {

double PathReference::way_m() const {
  return path_.length_m() * (path_.closed() ? static_cast<double>(config_.laps) : 1.0);
}

double PathReference::duration_s() const { return way_m() / config_.speed_m_s; }

geometry::Vector2 PathReference::target(double time_s, const geometry::Pose2& needle) {
  const geometry::Vector2 start_m = path_.at(0.0);
  if (approaching() && ((needle.position_m() - start_m).norm() <= config_.approach_radius_m ||
                        time_s >= config_.approach_limit_s))
    started_s_ = time_s;
  heading_rad_ = heading_at_rad(time_s);
  if (approaching()) return start_m;
  return moving_target(time_s);
}

geometry::Vector2 PathReference::moving_target(double time_s) const {
  return path_.at(config_.speed_m_s * (time_s - started_s_));
}

std::optional<double> PathReference::heading_at_rad(double time_s) const {
  constexpr double kSlack_m = 1e-9;  // times are sums of periods: a corner that is reached is one
  const double at_m = approaching() ? 0.0 : config_.speed_m_s * (time_s - started_s_);
  return path_.heading_rad(std::min(at_m + kSlack_m, way_m() - kSlack_m));
}

std::vector<task::TargetAhead> PathReference::ahead(double time_s, double step_s, int count) const {
  if (approaching() && path_.heading().rule() == geometry::HeadingRule::kNone) return {};
  std::vector<task::TargetAhead> points;
  for (int step = 1; step <= count; ++step) {
    const double in_s = step_s * step;
    const double then_s = std::min(time_s + in_s, started_s_ + duration_s());
    points.push_back({approaching() ? path_.at(0.0) : moving_target(then_s), in_s, heading_at_rad(then_s)});
  }
  return points;
}

bool PathReference::finished(double time_s) const {
  // Half a microsecond of slack, as times are sums of periods.
  return !approaching() && time_s - started_s_ >= duration_s() - 5e-7;
}

}  // namespace lodestone::control
