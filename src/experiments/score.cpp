#include "lodestone/experiments/score.h"

#include <algorithm>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"

namespace lodestone::experiments {

namespace {

constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;
constexpr double kMmPerM = 1000.0;

double distance_m(const ScoredSample& sample) { return (sample.position_m - sample.target_m).norm(); }

void note_reach(const std::vector<ScoredSample>& samples, double radius_m, TrialScore& score) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (distance_m(samples[i]) > radius_m) continue;
    score.steps_to_reach = static_cast<std::int64_t>(i);
    score.seconds_to_reach = samples[i].time_s - samples.front().time_s;
    return;
  }
}

/// Mean of what `get` finds, in `scale`; null when no trial has it.
template <class Get>
common::Json mean_of(const std::vector<const TrialScore*>& trials, double scale, Get get) {
  double sum = 0.0;
  std::int64_t count = 0;
  for (const TrialScore* trial : trials) {
    const auto& value = get(*trial);
    if (!value) continue;
    sum += static_cast<double>(*value);
    ++count;
  }
  if (count == 0) return nullptr;
  return scale * sum / static_cast<double>(count);
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
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  summary.median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return summary;
}

common::Json summarise_trials(const std::vector<const TrialScore*>& trials) {
  std::vector<double> errors_mm;
  double successes = 0.0;
  for (const TrialScore* trial : trials) {
    for (const double error_m : trial->errors_m) errors_mm.push_back(kMmPerM * error_m);
    successes += trial->success ? 1.0 : 0.0;
  }
  const ErrorSummary errors = summarise(errors_mm);
  common::Json json;
  json["mean_error_mm"] = errors.mean;
  json["std_error_mm"] = errors.std;
  json["median_error_mm"] = errors.median;
  json["rms_error_mm"] = errors.rms;
  json["success_rate"] = successes / static_cast<double>(trials.size());
  json["n_trials"] = trials.size();
  json["steps_to_reach"] = mean_of(trials, 1.0, [](const TrialScore& t) { return t.steps_to_reach; });
  json["seconds_to_reach"] = mean_of(trials, 1.0, [](const TrialScore& t) { return t.seconds_to_reach; });
  json["hold_error_mm"] = mean_of(trials, kMmPerM, [](const TrialScore& t) { return t.hold_error_m; });
  json["heading_error_deg"] =
      mean_of(trials, kDegPerRad, [](const TrialScore& t) { return t.heading_error_rad; });
  json["cross_track_rms_mm"] =
      mean_of(trials, kMmPerM, [](const TrialScore& t) { return t.cross_track_rms_m; });
  json["time_rms_error_mm"] = mean_of(trials, kMmPerM, [](const TrialScore& t) { return t.time_rms_m; });
  return json;
}

}  // namespace lodestone::experiments
