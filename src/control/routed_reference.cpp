#include "lodestone/control/routed_reference.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::control {

RoutedReference::RoutedReference(std::shared_ptr<Reference> inner, std::shared_ptr<const task::RouteMap> map,
                                 geometry::KeepOut keep_out, double waypoint_radius_m)
    : inner_(std::move(inner)),
      map_(std::move(map)),
      keep_out_(std::move(keep_out)),
      waypoint_radius_m_(waypoint_radius_m) {}

void RoutedReference::move_zones(std::vector<geometry::Zone> zones) {
  const std::lock_guard<std::mutex> lock(mutex_);
  coming_ = std::move(zones);
}

bool RoutedReference::zones_moved() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!coming_) return false;
  keep_out_.zones = std::move(*coming_);
  coming_.reset();
  return true;
}

void RoutedReference::reset() {
  inner_->reset();
  route_m_.clear();
  next_ = 0;
}

bool RoutedReference::search(const geometry::Vector2& position_m, const geometry::Vector2& goal_m) {
  std::vector<geometry::Vector2> found = map_->route(position_m, goal_m, keep_out_);
  if (found.empty()) return false;
  route_m_ = std::move(found);
  next_ = 1;
  leg_from_m_ = position_m;
  return true;
}

bool RoutedReference::strayed(const geometry::Vector2& position_m) const {
  return geometry::to_segment_m(position_m, leg_from_m_, route_m_[next_]) > map_->config().stray_m;
}

bool RoutedReference::passed(const geometry::Vector2& position_m) const {
  const geometry::Vector2& here_m = route_m_[next_];
  if ((here_m - position_m).norm() <= waypoint_radius_m_) return true;
  const geometry::Vector2& after_m = route_m_[next_ + 1];
  const double on_the_way_m =
      std::min(keep_out_.clearance_m(position_m, here_m), keep_out_.clearance_m(here_m, after_m));
  const double least_m = std::max(std::min(on_the_way_m, map_->wanted_m(keep_out_)), keep_out_.margin_m);
  return map_->straight(position_m, after_m, keep_out_, least_m);
}

geometry::Vector2 RoutedReference::target(double time_s, const geometry::Pose2& needle) {
  const geometry::Vector2 position_m = needle.position_m();
  const geometry::Vector2 goal_m = inner_->target(time_s, needle);
  const bool others = zones_moved();
  if (others || route_m_.empty() || route_m_.back() != goal_m) {
    if (!search(position_m, goal_m)) {
      route_m_.clear();  // the old one is none any more
      throw common::DataError(fmt::format(
          "no way leads from ({:.1f}, {:.1f}) mm to ({:.1f}, {:.1f}) mm within the part of the dish that can "
          "be reached and around its zones (safety.keep_out, safety.keep_out_file); choose another target, "
          "or smaller zones",
          1e3 * position_m.x(), 1e3 * position_m.y(), 1e3 * goal_m.x(), 1e3 * goal_m.y()));
    }
  } else if (strayed(position_m)) {
    search(position_m, goal_m);  // or on along the old one
  }
  while (!arriving() && passed(position_m)) {
    ++next_;
    leg_from_m_ = position_m;
  }
  return route_m_[next_];
}

std::optional<double> RoutedReference::target_heading_rad() const {
  return arriving() ? inner_->target_heading_rad() : std::nullopt;
}

std::vector<task::TargetAhead> RoutedReference::ahead(double time_s, double step_s, int count) const {
  if (!arriving()) return {};
  return inner_->ahead(time_s, step_s, count);
}

}  // namespace lodestone::control
