#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/control/control_loop.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/experiments/score.h"
#include "lodestone/geometry/keep_out.h"
#include "lodestone/geometry/stitch.h"
#include "lodestone/physics/obstacles.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/task/route_map.h"

namespace lodestone::experiments {

/// What one trial shall do.
struct TrialPlan {
  std::string task;  ///< "centre", "point", "pose", "square", "circle", "path" or "suture"
  std::int64_t index = 0;
  geometry::Pose2 start;
  geometry::Vector2 target_m = geometry::Vector2::Zero();  ///< point tasks
  std::optional<double> target_heading_rad;                ///< pose
  std::optional<geometry::Path> path;                      ///< path tasks
  double duration_s = 20.0;                                ///< point tasks
  control::PathReferenceConfig reference;                  ///< path tasks
  std::vector<geometry::Stitch> stitches;                  ///< suture
  std::vector<geometry::Stitch> aims;     ///< suture: aimed at instead of `stitches`; empty: at those
  control::SutureReferenceConfig suture;  ///< suture
  geometry::KeepOut keep_out;             ///< what the needle must keep out of, as it was planned
  std::vector<physics::ObstacleConfig> obstacles;  ///< drawn for it: in its rig, and among those zones
  std::shared_ptr<const task::RouteMap> routes;    ///< by which it is led to a point; null: straight to it
  double waypoint_radius_m = 0.004;                ///< a point of the way is passed within this
  bool unreachable = false;  ///< `routes` has no way past its obstacles: there is nothing to drive

  /// Whether the target moves: along a path, or through stitches.
  bool moves() const { return path || !stitches.empty(); }
};

/// One observation with the true pose beside it, where somebody knows it. Only scoring sees the latter.
struct TrialSample {
  control::StepRecord step;
  std::optional<geometry::Pose2> true_pose;
  bool approach = false;                          ///< still on the way to a path, or to a stitch
  std::optional<physics::PerCoil> temperature_C;  ///< of the coils, as reported last
  std::size_t stitch = 0;                         ///< of a suture, that it was at
};

/// All zones that the needle must keep out of, from some time on.
struct ToldZones {
  double time_s =
      0.0;  ///< of the observation at which they were noticed; that after the last: it was stopped
  std::vector<geometry::Zone> zones;
};

struct TrialResult {
  TrialPlan plan;
  std::string rig;         ///< "explored", "unseen" or "real"
  std::string controller;  ///< "policy", "planner" or "baseline"
  std::vector<TrialSample> samples;
  std::vector<ToldZones> told_zones;  ///< where a file tells them: at first, and whenever they were others
  bool completed = false;
  std::string stop_reason;
  std::optional<runs::TrialFigures> truth;  ///< absent where nobody knows the true pose
  runs::TrialFigures sensed;
};

/// Sees every sample as it is made, before its pulse.
using TrialWatch = std::function<void(const TrialSample&)>;

/// Where the needle truly is: for scoring only, and empty where nobody knows.
using TruePose = std::function<geometry::Pose2()>;

/// What is asked at every sample of what stands between a trial and its coils, where that is given.
struct BenchReport {
  std::function<std::optional<rig::CoilStatus>()> coils = {};  ///< what they told last; nothing before
  std::function<std::vector<geometry::Zone>()> keep_out = {};  ///< where a file tells zones: all of them now
};

/// Runs one trial and scores it; one that is unreachable is not driven, and has failed. Where zones move,
/// the needle is led around them from the next step on, and scored by those of each moment.
TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const TruePose& true_pose, const ScoreConfig& score, const TrialWatch& watch = {},
                      const BenchReport& report = {});

}  // namespace lodestone::experiments
