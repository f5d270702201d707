#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/runs/kept_results.h"

namespace lodestone::tests {

/// Kept results of the paper's plan, as made as they come.
class Kept {
 public:
  Kept() { kept.plan.name = "quick"; }

  runs::CellRecord& add(const std::string& id, bool finished = true) {
    kept.plan.cells.emplace_back().id = id;
    runs::CellRecord& record = finished ? kept.records[id] : unfinished_;
    record.machine = {{"git_commit", "abc"},
                      {"processor", "Fast"},
                      {"processors", 2},
                      {"time_utc", "2026-01-02T03:04:05Z"}};
    return record;
  }
  /// Trials that ended so far from the target; success below 3 mm.
  void add_trials(const std::string& id, std::int64_t seed, const std::vector<double>& errors_mm) {
    runs::CellRecord& record = add(id);
    record.seed = seed;
    runs::KeptTrials& trials = record.trials.emplace();
    trials.task = "centre";
    trials.controller = "planner";
    for (const double error_mm : errors_mm) {
      trials.error_mm.push_back(error_mm);
      trials.success.push_back(error_mm < 3.0 ? 1 : 0);
      trials.stopped.push_back(0);
    }
    runs::TrialRecord& drawn = trials.drawn.emplace_back();
    drawn.task = "centre";
    drawn.controller = "planner";
    drawn.target_mm = {0.0, 0.0};
    drawn.trajectory = {{20.0, 10.0, 0.1}, {0.5, 0.1, 0.3}};
    drawn.completed = true;
    drawn.truth.emplace().final_error_mm = errors_mm.front();
  }
  /// Evaluations a hundred steps and ten seconds apart.
  void add_training(const std::string& id, const std::vector<double>& returns) {
    runs::CellRecord& record = add(id);
    runs::PolicyResult& result = record.policy.emplace();
    runs::KeptCurve& curve = record.curve.emplace();
    for (std::size_t i = 0; i < returns.size(); ++i) {
      curve.env_steps.push_back(100.0 * static_cast<double>(i));
      curve.episode_return.push_back(returns[i]);
      curve.success_rate.push_back(0.5);
      curve.seconds.push_back(10.0 * static_cast<double>(i));
      curve.processor_seconds.push_back(9.0 * static_cast<double>(i));
    }
    result.env_steps = static_cast<std::int64_t>(curve.env_steps.back());
    result.train_seconds = curve.seconds.back();
    result.processor_seconds = curve.processor_seconds.back();
    result.fresh_evaluation.emplace().success_rate = 0.8;
  }

  runs::KeptPlan kept;

 private:
  runs::CellRecord unfinished_;
};

/// Returns of twenty evaluations.
const std::vector<double> kRisen = {0,  2,  4,  6,  8,  10, 10, 10, 10, 10,
                                    10, 10, 10, 10, 10, 10, 10, 10, 10, 10};
const std::vector<double> kRising = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19};

}  // namespace lodestone::tests
