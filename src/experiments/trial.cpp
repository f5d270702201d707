#include "lodestone/experiments/trial.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {

namespace {

/// The pose of a sample by one source of positions; nothing where that had none.
std::optional<geometry::Pose2> pose_of(const TrialSample& sample, bool truth) {
  if (truth) return sample.true_pose;
  if (!sample.step.estimate.valid) return std::nullopt;
  return sample.step.estimate.pose;
}

std::vector<ScoredSample> scored(const TrialResult& result, bool truth) {
  std::vector<ScoredSample> out;
  for (const TrialSample& sample : result.samples) {
    if (const auto pose = pose_of(sample, truth))
      out.push_back({sample.step.time_s, pose->position_m(), sample.step.target_m, sample.approach});
  }
  // A run without any pose was never seen to move: it is scored where it was to start.
  if (out.empty())
    out.push_back({0.0, result.plan.start.position_m(), result.samples.front().step.target_m, true});
  return out;
}

/// Error of the heading at the end of a trial whose target has one.
void note_heading(const TrialResult& result, double target_rad, bool truth, const ScoreConfig& config,
                  runs::TrialFigures& score) {
  std::optional<geometry::Pose2> last;
  for (const TrialSample& sample : result.samples) {
    if (const auto pose = pose_of(sample, truth)) last = pose;
  }
  if (!last) return;
  const double error_rad = std::abs(geometry::wrap_angle(last->heading_rad - target_rad));
  score.heading_error_deg = geometry::kDegPerRad * error_rad;
  score.success = score.success && error_rad <= config.success_heading_deg / geometry::kDegPerRad;
}

runs::TrialFigures score_trial(const TrialResult& result, bool truth, const ScoreConfig& config) {
  const TrialPlan& plan = result.plan;
  const std::vector<ScoredSample> samples = scored(result, truth);
  runs::TrialFigures score =
      plan.path ? score_path(samples, *plan.path, config) : score_point(samples, config);
  if (plan.target_heading_rad) note_heading(result, *plan.target_heading_rad, truth, config, score);
  score.success = score.success && result.completed;
  return score;
}

}  // namespace

TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const TruePose& true_pose, const ScoreConfig& score, const TrialWatch& watch,
                      const CoilTemperatures& temperatures) {
  TrialResult result;
  result.plan = plan;
  control::PointReference point(plan.target_m, plan.duration_s, plan.target_heading_rad);
  std::optional<control::PathReference> path;
  if (plan.path) path.emplace(*plan.path, plan.reference);
  control::Reference& reference = path ? static_cast<control::Reference&>(*path) : point;
  const auto truth = [&true_pose] { return true_pose ? std::optional(true_pose()) : std::nullopt; };
  const control::LoopOutcome outcome = loop.run(controller, reference, [&](const control::StepRecord& step) {
    result.samples.push_back({step, truth(), path && path->approaching(), {}});
    if (temperatures) result.samples.back().temperature_C = temperatures();
    if (watch) watch(result.samples.back());
  });
  result.completed = outcome.completed;
  result.stop_reason = outcome.stop_reason;
  // A fault before the first observation leaves nothing to score but where the needle lies.
  if (result.samples.empty()) {
    control::StepRecord step;
    step.target_m = plan.path ? plan.path->at(0.0) : plan.target_m;
    result.samples.push_back({step, truth(), plan.path.has_value(), std::nullopt});
  }
  if (true_pose) result.truth = score_trial(result, true, score);
  result.sensed = score_trial(result, false, score);
  return result;
}

}  // namespace lodestone::experiments
