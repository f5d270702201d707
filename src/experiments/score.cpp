#include "lodestone/experiments/score.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"

namespace lodestone::experiments {

namespace {

double distance_m(const ScoredSample& sample) { return (sample.position_m - sample.target_m).norm(); }

void note_reach(const std::vector<ScoredSample>& samples, double radius_m, TrialScore& score) {
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

TrialScore score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  TrialScore score;
  score.final_error_m = distance_m(samples.back());
  score.errors_m = {score.final_error_m};
  score.success = score.final_error_m <= config.success_radius_m;
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
    score.hold_error_m = sum_m / static_cast<double>(count);
  }
  return score;
}

TrialScore score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                      const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty(), "at least one sample to score");
  TrialScore score;
  std::vector<double> time_errors_m;
  for (const ScoredSample& sample : samples) {
    if (sample.approach) continue;
    score.errors_m.push_back(path.nearest(sample.position_m).distance_m);
    time_errors_m.push_back(distance_m(sample));
  }
  const bool followed = !score.errors_m.empty();
  if (!followed) {
    score.errors_m.push_back(path.nearest(samples.back().position_m).distance_m);
    time_errors_m.push_back(distance_m(samples.back()));
  }
  score.final_error_m = distance_m(samples.back());
  score.cross_track_rms_m = common::root_mean_square(score.errors_m);
  score.time_rms_m = common::root_mean_square(time_errors_m);
  score.success = followed && *score.cross_track_rms_m <= config.success_radius_m;
  note_reach(samples, config.success_radius_m, score);
  return score;
}

ErrorSummary summarise(std::vector<double> values) {
  LODESTONE_CHECK(!values.empty(), "at least one value to summarise");
  ErrorSummary summary;
  summary.mean = common::mean(values);
  summary.std = common::standard_deviation(values);
  summary.rms = common::root_mean_square(values);
  summary.median = common::median(std::move(values));
  return summary;
}

runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials) {
  std::vector<double> errors_mm;
  double successes = 0.0;
  for (const runs::TrialFigures* trial : trials) {
    errors_mm.insert(errors_mm.end(), trial->errors_mm.begin(), trial->errors_mm.end());
    successes += trial->success ? 1.0 : 0.0;
  }
  const ErrorSummary errors = summarise(errors_mm);
  using Figures = runs::TrialFigures;
  runs::ErrorStatistics out;
  out.mean_error_mm = errors.mean;
  out.std_error_mm = errors.std;
  out.median_error_mm = errors.median;
  out.rms_error_mm = errors.rms;
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
