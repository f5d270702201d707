#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "lodestone/control/reference.h"
#include "lodestone/task/route_map.h"

namespace lodestone::control {

/// Leads to another reference's target by a way around zones: whatever controls is given the points of the
/// way one after the other, and at last the target itself. A point is passed once the needle is near it, or
/// once the next one can be gone to straight without coming nearer to a zone than the way does. The way is
/// searched anew where zones or target move, or the needle strays.
class RoutedReference final : public Reference {
 public:
  RoutedReference(std::shared_ptr<Reference> inner, std::shared_ptr<const task::RouteMap> map,
                  geometry::KeepOut keep_out, double waypoint_radius_m);

  /// From any thread: from the next step on it is these zones.
  void move_zones(std::vector<geometry::Zone> zones);

  void reset() override;
  /// Throws common::DataError where no way leads to the target.
  geometry::Vector2 target(double time_s, const geometry::Pose2& needle) override;
  /// The target's own, once the needle is sent to it.
  std::optional<double> target_heading_rad() const override;
  /// Likewise.
  std::vector<task::TargetAhead> ahead(double time_s, double step_s, int count) const override;
  bool awaits() const override { return arriving() && inner_->awaits(); }
  bool finished(double time_s) const override { return inner_->finished(time_s); }

  /// The way as it was searched last, from where the needle was then.
  const std::vector<geometry::Vector2>& route_m() const { return route_m_; }

 private:
  bool arriving() const { return next_ + 1 >= route_m_.size(); }
  bool zones_moved();
  bool strayed(const geometry::Vector2& position_m) const;
  bool passed(const geometry::Vector2& position_m) const;
  /// Whether there is a way; where there is none the last one stays.
  bool search(const geometry::Vector2& position_m, const geometry::Vector2& goal_m);

  std::shared_ptr<Reference> inner_;
  std::shared_ptr<const task::RouteMap> map_;
  geometry::KeepOut keep_out_;
  double waypoint_radius_m_;
  std::vector<geometry::Vector2> route_m_;
  std::size_t next_ = 0;                                      // the point of it that is aimed at,
  geometry::Vector2 leg_from_m_ = geometry::Vector2::Zero();  // since the needle was here
  std::mutex mutex_;                                          // of the zones to come
  std::optional<std::vector<geometry::Zone>> coming_;
};

}  // namespace lodestone::control
