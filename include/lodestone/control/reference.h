#pragma once

#include <optional>
#include <vector>

#include "lodestone/geometry/path.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/task/observation.h"

namespace lodestone::control {

/// Of a target that moves, every controller is told so many steps.
inline constexpr int kStepsAhead = 20;

/// Where the needle should be now: the target handed to the controller at every step.
class Reference {
 public:
  virtual ~Reference() = default;
  /// Starts over.
  virtual void reset() = 0;
  /// Target at `time_s` since the start of the run, for a needle that was last sensed as it lies in `needle`.
  virtual geometry::Vector2 target(double time_s, const geometry::Pose2& needle) = 0;
  /// Heading the needle should lie at there, where the task wants one.
  virtual std::optional<double> target_heading_rad() const { return std::nullopt; }
  /// Where the target will be at each of the next `count` steps of `step_s`; empty for one that stays.
  virtual std::vector<task::TargetAhead> ahead(double /*time_s*/, double /*step_s*/, int /*count*/) const {
    return {};
  }
  /// True while the needle is waited for at a pose nearer to which a controller might not bring it unasked.
  virtual bool awaits() const { return false; }
  /// True once there is nothing left to follow.
  virtual bool finished(double time_s) const = 0;
};

/// A point that stays where it is, for a given time.
class PointReference final : public Reference {
 public:
  PointReference(const geometry::Vector2& point_m, double duration_s, std::optional<double> heading_rad = {})
      : point_m_(point_m), duration_s_(duration_s), heading_rad_(heading_rad) {}
  void reset() override {}
  geometry::Vector2 target(double, const geometry::Pose2&) override { return point_m_; }
  std::optional<double> target_heading_rad() const override { return heading_rad_; }
  bool finished(double time_s) const override { return time_s >= duration_s_; }

 private:
  geometry::Vector2 point_m_;
  double duration_s_;
  std::optional<double> heading_rad_;
};

/// How a path is fed to the controller.
struct PathReferenceConfig {
  double speed_m_s = 0.002;
  double approach_radius_m = 0.003;
  double approach_limit_s = 20.0;
  std::int64_t laps = 1;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("speed_m_s", speed_m_s, "m/s", "speed of the reference along the path", {1e-6, 1.0});
    v.field("approach_radius_m", approach_radius_m, "m",
            "the reference leaves the start of the path once the needle is sensed this close", {0.0, 1.0});
    v.field("approach_limit_s", approach_limit_s, "s", "or after this time at the latest", {0.0, 3600.0});
    v.field("laps", laps, "", "times around a closed path", {1, 1000});
  }
};

/// A point that waits at the start of the path until the needle has come there, then moves along at constant
/// speed: section V-D feeds the policy "each point along that path one by one, until the path is done". The
/// heading is the path's where the point is; where that jumps, at a corner say, it is that of the way on, and
/// at the end that of the way there.
class PathReference final : public Reference {
 public:
  PathReference(geometry::Path path, const PathReferenceConfig& config)
      : path_(std::move(path)), config_(config) {}
  void reset() override {
    started_s_ = -1.0;
    heading_rad_.reset();
  }
  geometry::Vector2 target(double time_s, const geometry::Pose2& needle) override;
  std::optional<double> target_heading_rad() const override { return heading_rad_; }
  /// Empty during the approach: when the target will set out depends on the needle. A path with headings is
  /// at its start all along then, so that nobody takes that for a pose to stay at.
  std::vector<task::TargetAhead> ahead(double time_s, double step_s, int count) const override;
  bool finished(double time_s) const override;

  /// True while the needle still approaches the start of the path.
  bool approaching() const { return started_s_ < 0.0; }
  const geometry::Path& path() const { return path_; }
  /// Time one run takes after the approach.
  double duration_s() const;

 private:
  double way_m() const;
  geometry::Vector2 moving_target(double time_s) const;
  std::optional<double> heading_at_rad(double time_s) const;

  geometry::Path path_;
  PathReferenceConfig config_;
  double started_s_ = -1.0;
  std::optional<double> heading_rad_;  // at the last target
};

}  // namespace lodestone::control
