#include "lodestone/experiments/trial.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/control/routed_reference.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/experiments/suture_score.h"
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

/// What leads the needle in a trial.
class Lead {
 public:
  explicit Lead(const TrialPlan& plan) : point_(plan.target_m, plan.duration_s, plan.target_heading_rad) {
    if (plan.path) path_.emplace(*plan.path, plan.reference);
    if (!plan.stitches.empty()) suture_.emplace(plan.aims.empty() ? plan.stitches : plan.aims, plan.suture);
    if (plan.routes && !plan.moves())
      routed_.emplace(std::make_shared<control::PointReference>(point_), plan.routes, plan.keep_out,
                      plan.waypoint_radius_m);
  }

  /// What it is scored by,
  control::Reference& reference() {
    if (path_) return *path_;
    if (suture_) return *suture_;
    return point_;
  }
  /// and what it follows.
  control::Reference& followed() { return routed_ ? *routed_ : reference(); }
  /// Around these zones from the next step on, where ways are searched.
  void move_zones(const std::vector<geometry::Zone>& zones) {
    if (routed_) routed_->move_zones(zones);
  }

  /// Whether the needle is still on its way to what is scored.
  bool approach() const { return (path_ && path_->approaching()) || (suture_ && suture_->approaching()); }
  std::size_t stitch() const { return suture_ ? suture_->stitch() : 0; }
  /// That a moving target takes, null for a point.
  const geometry::Path* way() const { return path_ ? &path_->path() : suture_ ? &suture_->way() : nullptr; }

 private:
  control::PointReference point_;
  std::optional<control::PathReference> path_;
  std::optional<control::SutureReference> suture_;
  std::optional<control::RoutedReference> routed_;
};

geometry::Pose2 last_sensed(const TrialResult& result) {
  geometry::Pose2 lies = result.plan.start;
  for (const TrialSample& sample : result.samples)
    if (const auto pose = pose_of(sample, /*truth=*/false)) lies = *pose;
  return lies;
}

std::vector<ScoredSample> missed_by(const TrialResult& result, Lead& lead, double period_s) {
  control::Reference& reference = lead.reference();
  const geometry::Pose2 lies = last_sensed(result);
  std::vector<ScoredSample> missed;
  double time_s = result.samples.back().step.time_s;
  while (!reference.finished(time_s)) {
    time_s += period_s;
    const geometry::Vector2 target_m = reference.target(time_s, lies);
    missed.push_back({time_s, lies.position_m(), target_m, lead.approach(), lies.heading_rad,
                      reference.target_heading_rad(), lead.stitch()});
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
    const geometry::Vector2& target_m = result.plan.moves() ? sample.step.target_m : result.plan.target_m;
    out.push_back({sample.step.time_s, lies.position_m(), target_m, sample.approach, lies.heading_rad,
                   sample.step.target_heading_rad, sample.stitch});
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

/// Of every pose that one source had, to where the needle lay at last, from the zones of that moment.
std::vector<double> clearances_m(const TrialResult& result, const Aftermath& after, bool truth) {
  geometry::KeepOut keep_out = result.plan.keep_out;
  auto moved = result.told_zones.begin();
  std::vector<double> clearances;
  const auto move_on = [&](double time_s) {
    for (; moved != result.told_zones.end() && moved->time_s <= time_s; ++moved)
      keep_out.zones = moved->zones;
  };
  for (const TrialSample& sample : result.samples) {
    move_on(sample.step.time_s);
    if (const auto pose = pose_of(sample, truth)) clearances.push_back(keep_out.clearance_m(*pose));
  }
  move_on(std::numeric_limits<double>::infinity());
  if (truth && after.truly_lies) clearances.push_back(keep_out.clearance_m(*after.truly_lies));
  return clearances;
}

/// What became of a trial to whose target no way leads.
control::LoopOutcome not_driven(const TrialPlan& plan) {
  control::LoopOutcome outcome;
  outcome.stop_reason = fmt::format(
      "no way leads from ({:.1f}, {:.1f}) mm to ({:.1f}, {:.1f}) mm past the obstacles of this trial "
      "(trials.obstacles): it was not driven",
      geometry::kMmPerM * plan.start.x_m, geometry::kMmPerM * plan.start.y_m,
      geometry::kMmPerM * plan.target_m.x(), geometry::kMmPerM * plan.target_m.y());
  return outcome;
}

/// Leads around zones that are no longer those of before, and keeps them.
void note_zones(std::vector<geometry::Zone> zones, double time_s, Lead& lead, TrialResult& result) {
  const bool first = result.told_zones.empty();
  const bool moved = zones != (first ? result.plan.keep_out.zones : result.told_zones.back().zones);
  if (!first && !moved) return;
  if (moved) lead.move_zones(zones);
  result.told_zones.push_back({time_s, std::move(zones)});
}

runs::TrialFigures score_task(const TrialPlan& plan, const std::vector<ScoredSample>& samples,
                              const ScoreConfig& config) {
  if (plan.path) return score_path(samples, *plan.path, config);
  if (!plan.stitches.empty()) return score_suture(samples, plan.stitches, config);
  return score_point(samples, config);
}

runs::TrialFigures score_trial(const TrialResult& result, const Aftermath& after, bool truth,
                               const ScoreConfig& config) {
  const TrialPlan& plan = result.plan;
  runs::TrialFigures score = score_task(plan, scored(result, after, truth), config);
  if (plan.target_heading_rad) note_heading(result, after, *plan.target_heading_rad, truth, config, score);
  score_keep_out(clearances_m(result, after, truth), score);
  score.success = score.success && result.completed;
  return score;
}

}  // namespace

TrialResult run_trial(const TrialPlan& plan, control::ControlLoop& loop, control::Controller& controller,
                      const TruePose& true_pose, const ScoreConfig& score, const TrialWatch& watch,
                      const BenchReport& report) {
  TrialResult result;
  result.plan = plan;
  Lead lead(plan);
  const auto truth = [&true_pose] { return true_pose ? std::optional(true_pose()) : std::nullopt; };
  const auto observe = [&](const control::StepRecord& step) {
    result.samples.push_back({step, truth(), lead.approach(), {}, lead.stitch()});
    if (const auto reported = report.coils ? report.coils() : std::nullopt)
      result.samples.back().temperature_C = reported->temperature_C;
    if (report.keep_out) note_zones(report.keep_out(), step.time_s, lead, result);
    if (watch) watch(result.samples.back());
  };
  if (report.keep_out) note_zones(report.keep_out(), 0.0, lead, result);  // since it was planned
  const control::LoopOutcome outcome =
      plan.unreachable ? not_driven(plan) : loop.run(controller, lead.followed(), observe);
  result.completed = outcome.completed;
  result.stop_reason = outcome.stop_reason;
  // It was not driven, or there was a fault before the first observation.
  if (result.samples.empty()) {
    control::StepRecord step;
    step.target_m = lead.way() != nullptr ? lead.way()->at(0.0) : plan.target_m;
    step.target_heading_rad = lead.way() != nullptr ? lead.way()->heading_rad(0.0) : plan.target_heading_rad;
    result.samples.push_back({step, truth(), plan.moves(), std::nullopt});
  }
  if (!result.completed && report.keep_out)  // which it may have been stopped by
    note_zones(report.keep_out(), result.samples.back().step.time_s + loop.period_s(), lead, result);
  Aftermath after;
  if (!result.completed) after = {missed_by(result, lead, loop.period_s()), truth()};
  if (true_pose) result.truth = score_trial(result, after, true, score);
  result.sensed = score_trial(result, after, false, score);
  return result;
}

}  // namespace lodestone::experiments
