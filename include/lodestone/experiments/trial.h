#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/control/control_loop.h"
#include "lodestone/experiments/score.h"

namespace lodestone::experiments {

/// What one trial shall do.
struct TrialPlan {
  std::string task;  ///< "centre", "point", "pose", "square", "circle" or "path"
  std::int64_t index = 0;
  geometry::Pose2 start;
  geometry::Vector2 target_m = geometry::Vector2::Zero();  ///< point tasks
  std::optional<double> target_heading_rad;                ///< pose
  std::optional<geometry::Path> path;                      ///< path tasks
  double duration_s = 20.0;                                ///< point tasks
  control::PathReferenceConfig reference;                  ///< path tasks
};

/// One observation with the true pose beside it. Only scoring sees the latter.
struct TrialSample {
  control::StepRecord step;
  geometry::Pose2 true_pose;
  bool approach = false;
};

struct TrialResult {
  TrialPlan plan;
  std::string rig;         ///< "explored" or "unseen"
  std::string controller;  ///< "policy" or "baseline"
  std::vector<TrialSample> samples;
  bool completed = false;
  std::string stop_reason;
  TrialScore truth;
  TrialScore sensed;
};

/// Runs one trial and scores it. `true_pose` is for scoring only. `watch`, when given, sees every observation
/// before its pulse.
TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const std::function<geometry::Pose2()>& true_pose, const ScoreConfig& score,
                      const control::ControlLoop::Observer& watch = {});

}  // namespace lodestone::experiments
