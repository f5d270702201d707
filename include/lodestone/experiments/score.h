#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lodestone/geometry/path.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {

/// One moment of a run, for scoring.
struct ScoredSample {
  double time_s = 0.0;
  geometry::Vector2 position_m = geometry::Vector2::Zero();
  geometry::Vector2 target_m = geometry::Vector2::Zero();
  bool approach = false;  ///< still on the way to the start of a path: not scored
};

/// How well one trial went, by one source of positions (true, or as sensed).
struct TrialScore {
  std::vector<double>
      errors_m;  ///< point: the distance at the end; path: the cross-track error of every sample
  double final_error_m = 0.0;          ///< distance to the target at the end
  bool success = false;                ///< point: final error within the radius; path: its cross-track RMS is
  std::optional<double> hold_error_m;  ///< mean distance at the end of a trial that reached (point only)
  std::optional<double> heading_error_rad;  ///< at the end; pose only
  std::optional<double> cross_track_rms_m;  ///< path only
  std::optional<double> time_rms_m;         ///< RMS distance to the moving reference, path only
  std::optional<std::int64_t>
      steps_to_reach;  ///< pulses until the target (the start of the path) was reached
  std::optional<double> seconds_to_reach;
};

/// Rules of scoring.
struct ScoreConfig {
  double success_radius_m = 0.003;
  double hold_s = 5.0;
  double success_heading_deg = 15.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("success_radius_m", success_radius_m, "m", "distance that counts as reached", {1e-5, 1.0});
    v.field("success_heading_deg", success_heading_deg, "deg",
            "heading error that counts as reached (task pose)", {0.1, 180.0});
    v.field("hold_s", hold_s, "s",
            "the error while holding is the mean over this long at the end, from the first "
            "time within the success radius on",
            {0.0, 3600.0});
  }
};

/// Scores a run to a fixed point. `samples` holds at least one; the last one closes the run.
TrialScore score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config);

/// Scores a run along a path. A run that never left the approach is scored by its last sample, and failed.
TrialScore score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                      const ScoreConfig& config);

/// Mean, sample standard deviation, median and root mean square.
struct ErrorSummary {
  double mean = 0.0;
  double std = 0.0;
  double median = 0.0;
  double rms = 0.0;
};

/// Throws LogicFault when there are no values.
ErrorSummary summarise(std::vector<double> values);

/// Throws LogicFault when there are no trials.
runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials);
/// One task by one controller; the trials need not hold their trajectories any more.
runs::TaskSummary summarise_task(const std::vector<runs::TrialRecord>& trials);

}  // namespace lodestone::experiments
