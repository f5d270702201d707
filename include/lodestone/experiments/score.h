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

/// Scores a run to a fixed point: reached where the last distance is within the radius. `samples` holds at
/// least one; the last one closes the run.
runs::TrialFigures score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config);

/// Scores a run along a path: reached where its cross-track RMS is within the radius. A run that never left
/// the approach is scored by its last sample, and failed.
runs::TrialFigures score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                              const ScoreConfig& config);

/// Throws LogicFault when there are no trials.
runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials);
/// One task by one controller; the trials need not hold their trajectories any more.
runs::TaskSummary summarise_task(const std::vector<runs::TrialRecord>& trials);

}  // namespace lodestone::experiments
