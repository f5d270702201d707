#include "lodestone/experiments/score.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/pose2.h"

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

}  // namespace

runs::TrialFigures score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  runs::TrialFigures score;
  const double final_error_m = distance_m(samples.back());
  score.final_error_mm = geometry::kMmPerM * final_error_m;
  score.errors_mm = {score.final_error_mm};
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

runs::TrialFigures score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                              const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  runs::TrialFigures score;
  std::vector<double> errors_m;
  std::vector<double> time_errors_m;
  const auto add = [&](const ScoredSample& sample) {
    errors_m.push_back(path.nearest(sample.position_m).distance_m);
    time_errors_m.push_back(distance_m(sample));
  };
  for (const ScoredSample& sample : samples)
    if (!sample.approach) add(sample);
  const bool followed = !errors_m.empty();
  if (!followed) add(samples.back());
  for (const double error_m : errors_m) score.errors_mm.push_back(geometry::kMmPerM * error_m);
  const double cross_track_rms_m = common::root_mean_square(errors_m);
  score.final_error_mm = geometry::kMmPerM * distance_m(samples.back());
  score.cross_track_rms_mm = geometry::kMmPerM * cross_track_rms_m;
  score.time_rms_error_mm = geometry::kMmPerM * common::root_mean_square(time_errors_m);
  score.success = followed && cross_track_rms_m <= config.success_radius_m;
  note_reach(samples, config.success_radius_m, score);
  return score;
}

runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials) {
  std::vector<double> errors_mm;
  double successes = 0.0;
  for (const runs::TrialFigures* trial : trials) {
    errors_mm.insert(errors_mm.end(), trial->errors_mm.begin(), trial->errors_mm.end());
    successes += trial->success ? 1.0 : 0.0;
  }
  LODESTONE_CHECK(!errors_mm.empty(), "at least one error to summarise");
  using Figures = runs::TrialFigures;
  runs::ErrorStatistics out;
  out.mean_error_mm = common::mean(errors_mm);
  out.std_error_mm = common::standard_deviation(errors_mm);
  out.rms_error_mm = common::root_mean_square(errors_mm);
  std::sort(errors_mm.begin(), errors_mm.end());
  const std::size_t half = errors_mm.size() / 2;
  out.median_error_mm =
      errors_mm.size() % 2 == 1 ? errors_mm[half] : 0.5 * (errors_mm[half - 1] + errors_mm[half]);
  out.success_rate = successes / static_cast<double>(trials.size());
  out.steps_to_reach = mean_of(trials, &Figures::steps_to_reach);
  out.seconds_to_reach = mean_of(trials, &Figures::seconds_to_reach);
  out.hold_error_mm = mean_of(trials, &Figures::hold_error_mm);
  out.heading_error_deg = mean_of(trials, &Figures::heading_error_deg);
  out.cross_track_rms_mm = mean_of(trials, &Figures::cross_track_rms_mm);
  out.time_rms_error_mm = mean_of(trials, &Figures::time_rms_error_mm);
  return out;
}

runs::TaskSummary summarise_task(const std::vector<runs::TrialRecord>& trials) {
  runs::TaskSummary summary;
  std::vector<const runs::TrialFigures*> truth;
  std::vector<const runs::TrialFigures*> sensed;
  for (const runs::TrialRecord& trial : trials) {
    ++summary.n_trials;
    if (!trial.completed) ++summary.n_stopped;
    if (trial.truth) truth.push_back(&*trial.truth);
    sensed.push_back(&trial.sensed);
  }
  if (!truth.empty()) summary.truth = summarise_trials(truth);
  summary.sensed = summarise_trials(sensed);
  return summary;
}

}  // namespace lodestone::experiments
