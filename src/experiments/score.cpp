#include "lodestone/experiments/score.h"

#include <algorithm>
#include <array>
#include <limits>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/frechet.h"

namespace lodestone::experiments {

namespace {

double distance_m(const ScoredSample& sample) { return (sample.position_m - sample.target_m).norm(); }

void note_reach(const std::vector<ScoredSample>& samples, double radius_m, runs::TrialFigures& score) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (distance_m(samples[i]) > radius_m) continue;
    score.steps_to_reach = static_cast<std::int64_t>(i);
    score.seconds_to_reach = samples[i].time_s - samples.front().time_s;
    return;
  }
}

/// How near the needle came to each corner of the path, where it has any.
void note_corners(const std::vector<geometry::Vector2>& needle_m, const geometry::Path& path,
                  const ScoreConfig& config, runs::TrialFigures& score) {
  const std::vector<geometry::Vector2> corners_m = path.corners_m();
  if (corners_m.empty()) return;
  double reached = 0.0;
  score.corner_errors_mm.emplace();
  for (const geometry::Vector2& corner_m : corners_m) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const geometry::Vector2& position_m : needle_m)
      nearest_m = std::min(nearest_m, (position_m - corner_m).norm());
    score.corner_errors_mm->push_back(geometry::kMmPerM * nearest_m);
    if (nearest_m <= config.success_radius_m)
      reached += 1.0;
    else
      score.success = false;
  }
  score.corners_reached = reached / static_cast<double>(corners_m.size());
}

/// Mean of a figure over the trials that have it.
template <class Value>
std::optional<double> mean_of(const std::vector<const runs::TrialFigures*>& trials,
                              std::optional<Value> runs::TrialFigures::*figure) {
  std::vector<double> values;
  for (const runs::TrialFigures* trial : trials)
    if (trial->*figure) values.push_back(static_cast<double>(*(trial->*figure)));
  if (values.empty()) return std::nullopt;
  return common::mean(values);
}

/// What keeping out of zones came to, over the trials that had any.
void note_touches(const std::vector<const runs::TrialFigures*>& trials, runs::ErrorStatistics& out) {
  std::int64_t known = 0;
  std::int64_t touching = 0;
  double least_mm = std::numeric_limits<double>::infinity();
  for (const runs::TrialFigures* trial : trials) {
    if (!trial->clearance_mm || !trial->touches) continue;
    ++known;
    if (*trial->touches > 0) ++touching;
    least_mm = std::min(least_mm, *trial->clearance_mm);
  }
  if (known == 0) return;
  out.least_clearance_mm = least_mm;
  out.touching_rate = static_cast<double>(touching) / static_cast<double>(known);
  const common::Interval interval = common::wilson_interval(touching, known);
  out.touching_interval = std::array<double, 2>{interval.low, interval.high};
}

}  // namespace

runs::TrialFigures score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  runs::TrialFigures score;
  const double final_error_m = distance_m(samples.back());
  score.final_error_mm = geometry::kMmPerM * final_error_m;
  score.success = final_error_m <= config.success_radius_m;
  note_reach(samples, config.success_radius_m, score);
  if (score.seconds_to_reach) {
    const double from_s =
        std::max(samples.front().time_s + *score.seconds_to_reach, samples.back().time_s - config.hold_s) -
        1e-9;
    double sum_m = 0.0;
    std::int64_t count = 0;
    for (const ScoredSample& sample : samples) {
      if (sample.time_s < from_s) continue;
      sum_m += distance_m(sample);
      ++count;
    }
    score.hold_error_mm = geometry::kMmPerM * (sum_m / static_cast<double>(count));
  }
  return score;
}

double completion(const std::vector<ScoredSample>& samples, const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  constexpr double kSlack_s = 1e-6;  // times are sums of periods
  std::vector<std::int64_t> reached(samples.size(),
                                    0);  // points so far, the last of them at this sample or before
  std::size_t first = 0;
  for (const ScoredSample& point : samples) {
    while (samples[first].time_s < point.time_s - config.completion_window_s - kSlack_s) ++first;
    std::int64_t most = 0;
    for (std::size_t i = first; i < samples.size(); ++i) {
      const bool in_time = samples[i].time_s <= point.time_s + config.completion_window_s + kSlack_s;
      if (in_time && (samples[i].position_m - point.target_m).norm() <= config.success_radius_m)
        most = std::max(most, reached[i] + 1);
      if (!in_time && reached[i] >= most) break;  // and so are all later ones
      reached[i] = std::max(reached[i], most);
    }
  }
  return static_cast<double>(reached.back()) / static_cast<double>(samples.size());
}

runs::TrialFigures score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                              const ScoreConfig& config) {
  std::vector<ScoredSample> followed;
  for (const ScoredSample& sample : samples)
    if (!sample.approach) followed.push_back(sample);
  LODESTONE_CHECK(!followed.empty(), "at least one sample that is not of the approach");
  std::vector<double> cross_track_mm;
  std::vector<double> to_target_mm;
  std::vector<double> heading_error_deg;
  std::vector<geometry::Vector2> needle_m;
  std::vector<geometry::Vector2> reference_m;
  for (const ScoredSample& sample : followed) {
    cross_track_mm.push_back(geometry::kMmPerM * path.nearest(sample.position_m).distance_m);
    to_target_mm.push_back(geometry::kMmPerM * distance_m(sample));
    if (sample.target_heading_rad)
      heading_error_deg.push_back(geometry::kDegPerRad *
                                  geometry::wrap_angle(sample.heading_rad - *sample.target_heading_rad));
    needle_m.push_back(sample.position_m);
    reference_m.push_back(sample.target_m);
  }
  runs::TrialFigures score;
  score.final_error_mm = to_target_mm.back();
  score.cross_track_rms_mm = common::root_mean_square(cross_track_mm);
  score.time_rms_error_mm = common::root_mean_square(to_target_mm);
  score.target_deviation_mm = common::mean(to_target_mm);
  score.frechet_mm = geometry::kMmPerM * geometry::discrete_frechet_m(needle_m, reference_m);
  score.completion = completion(followed, config);
  score.success = *score.completion >= config.success_completion &&
                  *score.cross_track_rms_mm <= geometry::kMmPerM * config.success_radius_m;
  if (!heading_error_deg.empty()) {
    score.heading_rms_deg = common::root_mean_square(heading_error_deg);
    score.success = score.success && *score.heading_rms_deg <= config.success_heading_deg;
  }
  note_corners(needle_m, path, config, score);
  note_reach(samples, config.success_radius_m, score);
  return score;
}

void score_keep_out(const std::vector<double>& clearances_m, runs::TrialFigures& score) {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  double least_m = kNone_m;
  std::int64_t touches = 0;
  bool touched = false;
  for (const double clearance_m : clearances_m) {
    least_m = std::min(least_m, clearance_m);
    const bool touching = clearance_m <= 0.0;
    if (touching && !touched) ++touches;
    touched = touching;
  }
  if (least_m == kNone_m) return;
  score.clearance_mm = geometry::kMmPerM * least_m;
  score.touches = touches;
  score.success = score.success && touches == 0;
}

runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials) {
  LODESTONE_CHECK(!trials.empty(), "at least one trial to summarise");
  std::vector<double> errors_mm;
  double successes = 0.0;
  for (const runs::TrialFigures* trial : trials) {
    errors_mm.push_back(trial->error_mm());
    successes += trial->success ? 1.0 : 0.0;
  }
  using Figures = runs::TrialFigures;
  runs::ErrorStatistics out;
  out.mean_error_mm = common::mean(errors_mm);
  out.std_error_mm = common::standard_deviation(errors_mm);
  out.rms_error_mm = common::root_mean_square(errors_mm);
  out.median_error_mm = common::median(errors_mm);
  out.success_rate = successes / static_cast<double>(trials.size());
  out.steps_to_reach = mean_of(trials, &Figures::steps_to_reach);
  out.seconds_to_reach = mean_of(trials, &Figures::seconds_to_reach);
  out.hold_error_mm = mean_of(trials, &Figures::hold_error_mm);
  out.heading_error_deg = mean_of(trials, &Figures::heading_error_deg);
  out.heading_rms_deg = mean_of(trials, &Figures::heading_rms_deg);
  out.cross_track_rms_mm = mean_of(trials, &Figures::cross_track_rms_mm);
  out.time_rms_error_mm = mean_of(trials, &Figures::time_rms_error_mm);
  out.target_deviation_mm = mean_of(trials, &Figures::target_deviation_mm);
  out.frechet_mm = mean_of(trials, &Figures::frechet_mm);
  out.stitches_made = mean_of(trials, &Figures::stitches_made);
  out.stitches_made_share = mean_of(trials, &Figures::stitches_made_share);
  out.stitch_rms_mm = mean_of(trials, &Figures::stitch_rms_mm);
  out.stitch_worst_mm = mean_of(trials, &Figures::stitch_worst_mm);
  out.stitch_worst_deg = mean_of(trials, &Figures::stitch_worst_deg);
  out.completion = mean_of(trials, &Figures::completion);
  out.corners_reached = mean_of(trials, &Figures::corners_reached);
  out.clearance_mm = mean_of(trials, &Figures::clearance_mm);
  out.touches = mean_of(trials, &Figures::touches);
  out.duration_s = mean_of(trials, &Figures::duration_s);
  out.charge_As = mean_of(trials, &Figures::charge_As);
  out.heat_J = mean_of(trials, &Figures::heat_J);
  note_touches(trials, out);
  return out;
}

runs::TaskSummary summarise_task(const std::vector<runs::TrialRecord>& trials) {
  runs::TaskSummary summary;
  summary.rig_changed = 0;
  std::vector<const runs::TrialFigures*> truth;
  std::vector<const runs::TrialFigures*> sensed;
  for (const runs::TrialRecord& trial : trials) {
    ++summary.n_trials;
    if (!trial.completed) ++summary.stopped;
    if (trial.rig_changed_s) ++*summary.rig_changed;
    if (trial.unreachable)
      summary.unreachable = summary.unreachable.value_or(0) + (*trial.unreachable ? 1 : 0);
    if (trial.truth) truth.push_back(&*trial.truth);
    sensed.push_back(&trial.sensed);
  }
  if (!truth.empty()) summary.truth = summarise_trials(truth);
  summary.sensed = summarise_trials(sensed);
  return summary;
}

}  // namespace lodestone::experiments
