#include "lodestone/experiments/trial.h"

#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::experiments {

namespace {

constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;

std::vector<ScoredSample> scored(const std::vector<TrialSample>& samples, bool truth) {
  std::vector<ScoredSample> out;
  for (const TrialSample& sample : samples) {
    if (!truth && !sample.step.estimate.valid) continue;
    out.push_back({sample.step.time_s,
                   truth ? sample.true_pose.position_m() : sample.step.estimate.pose.position_m(),
                   sample.step.target_m, sample.approach});
  }
  // A run without any pose was never seen to move: it is scored where it started.
  if (out.empty())
    out.push_back({0.0, samples.front().true_pose.position_m(), samples.front().step.target_m, true});
  return out;
}

/// Error of the heading at the end of a trial whose target has one.
void note_heading(const TrialResult& result, double target_rad, bool truth, const ScoreConfig& config,
                  TrialScore& score) {
  const TrialSample* last = nullptr;
  for (const TrialSample& sample : result.samples) {
    if (truth || sample.step.estimate.valid) last = &sample;
  }
  if (last == nullptr) return;
  const double heading_rad = truth ? last->true_pose.heading_rad : last->step.estimate.pose.heading_rad;
  score.heading_error_rad = std::abs(geometry::wrap_angle(heading_rad - target_rad));
  score.success = score.success && *score.heading_error_rad <= config.success_heading_deg / kDegPerRad;
}

}  // namespace

TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const std::function<geometry::Pose2()>& true_pose, const ScoreConfig& score,
                      const control::ControlLoop::Observer& watch) {
  TrialResult result;
  result.plan = plan;
  control::PointReference point(plan.target_m, plan.duration_s, plan.target_heading_rad);
  std::optional<control::PathReference> path;
  if (plan.path) path.emplace(*plan.path, plan.reference);
  control::Reference& reference = path ? static_cast<control::Reference&>(*path) : point;
  const control::LoopOutcome outcome = loop.run(controller, reference, [&](const control::StepRecord& step) {
    result.samples.push_back({step, true_pose(), path && path->approaching()});
    if (watch) watch(step);
  });
  result.completed = outcome.completed;
  result.stop_reason = outcome.stop_reason;
  // A fault before the first observation leaves nothing to score but where the needle lies.
  if (result.samples.empty()) {
    control::StepRecord step;
    step.target_m = plan.path ? plan.path->at(0.0) : plan.target_m;
    result.samples.push_back({step, true_pose(), plan.path.has_value()});
  }
  const auto scored_by = [&](bool truth) {
    const std::vector<ScoredSample> samples = scored(result.samples, truth);
    TrialScore out = plan.path ? score_path(samples, *plan.path, score) : score_point(samples, score);
    if (plan.target_heading_rad) note_heading(result, *plan.target_heading_rad, truth, score, out);
    out.success = out.success && result.completed;
    return out;
  };
  result.truth = scored_by(true);
  result.sensed = scored_by(false);
  return result;
}

}  // namespace lodestone::experiments
