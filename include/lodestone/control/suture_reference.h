#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lodestone/control/reference.h"
#include "lodestone/geometry/path.h"
#include "lodestone/geometry/stitch.h"

namespace lodestone::control {

/// How stitches are fed to the controller.
struct SutureReferenceConfig {
  double approach_m = 0.0;
  double leave_m = 0.006;
  double speed_m_s = 0.002;
  double arrive_m = 0.0005;
  double arrive_deg = 5.0;
  double arrive_limit_s = 120.0;
  std::int64_t rehearsals = 8;
  double aside_m = 0.0005;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("approach_m", approach_m, "m",
            "the needle is aligned so far before the entry of a stitch, along its heading", {0.0, 0.1});
    v.field(
        "leave_m", leave_m, "m",
        "and the target moves on so far beyond the exit, along its heading, before the next one: more than a "
        "needle may be late (planner.along_slack_m), or it would not come to the exit",
        {0.0, 0.1});
    v.field("speed_m_s", speed_m_s, "m/s", "speed of the target through a stitch", {1e-6, 1.0});
    v.field("arrive_m", arrive_m, "m",
            "it is pushed once it is sensed this close to where it is aligned, or as close as what holds it "
            "near a target brings it (decorators.hold_radius_m, turn.leave_m)",
            {0.0, 0.1});
    v.field("arrive_deg", arrive_deg, "deg",
            "and as near to the heading, likewise (decorators.hold_heading_deg, turn.heading_deg)",
            {0.1, 180.0});
    v.field("arrive_limit_s", arrive_limit_s, "s", "or after this time for each stitch at the latest",
            {0.0, 3600.0});
    v.field("rehearsals", rehearsals, "",
            "so often deploy rehearses each push in the learned simulator before the first stitch, to aim "
            "beside entry and exit by what the needle drifts; 0: straight at both",
            {0, 1000});
    v.field("aside_m", aside_m, "m", "at most so far beside either", {0.0, 0.1});
  }
};

/// Leads a needle through stitches, one after another: waits at the entry, or before it, until the needle has
/// come there and lies along its heading, then moves at constant speed along geometry::way_through() to
/// behind the exit. All the way it wants the heading of the way.
class SutureReference final : public Reference {
 public:
  /// Throws common::LogicFault without stitches, and as geometry::way_through().
  SutureReference(const std::vector<geometry::Stitch>& stitches, const SutureReferenceConfig& config);
  void reset() override;
  geometry::Vector2 target(double time_s, const geometry::Pose2& needle) override;
  std::optional<double> target_heading_rad() const override { return heading_rad_; }
  /// Empty while the needle is waited for: that is a pose to stay at.
  std::vector<task::TargetAhead> ahead(double time_s, double step_s, int count) const override;
  bool awaits() const override { return approaching(); }
  bool finished(double time_s) const override;

  /// The stitch that it is at, from 0; when all are done the last one.
  std::size_t stitch() const { return stitch_; }
  /// True while the needle is waited for before that stitch, false while it is pushed through.
  bool approaching() const { return pushed_s_ < 0.0; }
  /// Through that stitch, from where the needle is waited for.
  const geometry::Path& way() const { return ways_[stitch_]; }

 private:
  bool arrived(const geometry::Pose2& needle) const;
  bool through(double time_s) const;
  double arc_m(double time_s) const;

  std::vector<geometry::Path> ways_;
  SutureReferenceConfig config_;
  std::size_t stitch_ = 0;
  double since_s_ = 0.0;               // it is at this stitch,
  double pushed_s_ = -1.0;             // and the needle is pushed
  std::optional<double> heading_rad_;  // at the last target
};

}  // namespace lodestone::control
