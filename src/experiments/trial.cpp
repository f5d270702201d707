#include "lodestone/experiments/trial.h"

#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/control/routed_reference.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {

namespace {

/// The pose of a sample by one source of positions; nothing where that had none.
std::optional<geometry::Pose2> pose_of(const TrialSample& sample, bool truth) {
  if (truth) return sample.true_pose;
  if (!sample.step.estimate.valid) return std::nullopt;
  return sample.step.estimate.pose;
}

/// What came of a trial that was stopped: the rest of its schedule, and where the needle lay meanwhile, where
/// anybody knows. Empty for one that ended at its time.
struct Aftermath {
  std::vector<ScoredSample> missed;  ///< with the needle where it was seen last
  std::optional<geometry::Pose2> truly_lies;
};

/// One moment of a run with the needle at a pose.
ScoredSample moment(double time_s, const geometry::Pose2& lies, const geometry::Vector2& target_m,
                    bool approach, const std::optional<double>& target_heading_rad) {
  return {time_s, lies.position_m(), target_m, approach, lies.heading_rad, target_heading_rad};
}

geometry::Pose2 last_sensed(const TrialResult& result) {
  geometry::Pose2 lies = result.plan.start;
  for (const TrialSample& sample : result.samples)
    if (const auto pose = pose_of(sample, /*truth=*/false)) lies = *pose;
  return lies;
}

std::vector<ScoredSample> missed_by(const TrialResult& result, control::Reference& reference,
                                    const control::PathReference* path, double period_s) {
  const geometry::Pose2 lies = last_sensed(result);
  std::vector<ScoredSample> missed;
  double time_s = result.samples.back().step.time_s;
  while (!reference.finished(time_s)) {
    time_s += period_s;
    const geometry::Vector2 target_m = reference.target(time_s, lies);
    missed.push_back(moment(time_s, lies, target_m, path != nullptr && path->approaching(),
                            reference.target_heading_rad()));
  }
  return missed;
}

/// Every observation, with the needle where it was found last, at first where it was to start; then the
/// aftermath. At a point the error is that to the point, wherever the needle was led over.
std::vector<ScoredSample> scored(const TrialResult& result, const Aftermath& after, bool truth) {
  std::vector<ScoredSample> out;
  geometry::Pose2 lies = result.plan.start;
  for (const TrialSample& sample : result.samples) {
    if (const auto pose = pose_of(sample, truth)) lies = *pose;
    const geometry::Vector2& target_m = result.plan.path ? sample.step.target_m : result.plan.target_m;
    out.push_back(
        moment(sample.step.time_s, lies, target_m, sample.approach, sample.step.target_heading_rad));
  }
  if (truth && after.truly_lies) lies = *after.truly_lies;
  for (ScoredSample sample : after.missed) {
    sample.position_m = lies.position_m();
    sample.heading_rad = lies.heading_rad;
    out.push_back(sample);
  }
  return out;
}

/// Error of the heading at the end of a trial whose target has one.
void note_heading(const TrialResult& result, const Aftermath& after, double target_rad, bool truth,
                  const ScoreConfig& config, runs::TrialFigures& score) {
  std::optional<geometry::Pose2> last;
  for (const TrialSample& sample : result.samples)
    if (const auto pose = pose_of(sample, truth)) last = pose;
  if (truth && after.truly_lies) last = after.truly_lies;
  if (!last) return;
  const double error_rad = std::abs(geometry::wrap_angle(last->heading_rad - target_rad));
  score.heading_error_deg = geometry::kDegPerRad * error_rad;
  score.success = score.success && error_rad <= config.success_heading_deg / geometry::kDegPerRad;
}

/// Every pose that one source had, to where the needle lay at last.
std::vector<geometry::Pose2> known_poses(const TrialResult& result, const Aftermath& after, bool truth) {
  std::vector<geometry::Pose2> poses;
  for (const TrialSample& sample : result.samples)
    if (const auto pose = pose_of(sample, truth)) poses.push_back(*pose);
  if (truth && after.truly_lies) poses.push_back(*after.truly_lies);
  return poses;
}

runs::TrialFigures score_trial(const TrialResult& result, const Aftermath& after, bool truth,
                               const ScoreConfig& config) {
  const TrialPlan& plan = result.plan;
  const std::vector<ScoredSample> samples = scored(result, after, truth);
  runs::TrialFigures score =
      plan.path ? score_path(samples, *plan.path, config) : score_point(samples, config);
  if (plan.target_heading_rad) note_heading(result, after, *plan.target_heading_rad, truth, config, score);
  score_keep_out(known_poses(result, after, truth), plan.keep_out, score);
  score.success = score.success && result.completed;
  return score;
}

}  // namespace

TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const TruePose& true_pose, const ScoreConfig& score, const TrialWatch& watch,
                      const CoilReport& report) {
  TrialResult result;
  result.plan = plan;
  control::PointReference point(plan.target_m, plan.duration_s, plan.target_heading_rad);
  std::optional<control::PathReference> path;
  if (plan.path) path.emplace(*plan.path, plan.reference);
  control::Reference& reference = path ? static_cast<control::Reference&>(*path) : point;
  std::optional<control::RoutedReference> routed;
  if (plan.routes && !path)
    routed.emplace(std::make_shared<control::PointReference>(point), plan.routes, plan.keep_out,
                   plan.waypoint_radius_m);
  control::Reference& followed = routed ? static_cast<control::Reference&>(*routed) : reference;
  const auto truth = [&true_pose] { return true_pose ? std::optional(true_pose()) : std::nullopt; };
  const control::LoopOutcome outcome = loop.run(controller, followed, [&](const control::StepRecord& step) {
    result.samples.push_back({step, truth(), path && path->approaching(), {}});
    if (const auto reported = report ? report() : std::nullopt)
      result.samples.back().temperature_C = reported->temperature_C;
    if (watch) watch(result.samples.back());
  });
  result.completed = outcome.completed;
  result.stop_reason = outcome.stop_reason;
  // A fault before the first observation.
  if (result.samples.empty()) {
    control::StepRecord step;
    step.target_m = plan.path ? plan.path->at(0.0) : plan.target_m;
    step.target_heading_rad = plan.path ? plan.path->heading_rad(0.0) : plan.target_heading_rad;
    result.samples.push_back({step, truth(), plan.path.has_value(), std::nullopt});
  }
  Aftermath after;
  if (!result.completed)
    after = {missed_by(result, reference, path ? &*path : nullptr, loop.period_s()), truth()};
  if (true_pose) result.truth = score_trial(result, after, true, score);
  result.sensed = score_trial(result, after, false, score);
  return result;
}

}  // namespace lodestone::experiments
