#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lodestone/geometry/keep_out.h"
#include "lodestone/geometry/path.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {

/// One moment of a run, for scoring: where the needle was, or lay as far as anybody knows, and where it
/// should be.
struct ScoredSample {
  double time_s = 0.0;
  geometry::Vector2 position_m = geometry::Vector2::Zero();
  geometry::Vector2 target_m = geometry::Vector2::Zero();
  bool approach = false;  ///< still on the way to the start of a path, or to a stitch: not scored
  double heading_rad = 0.0;
  std::optional<double> target_heading_rad = {};  ///< where a path wants one
  std::size_t stitch = 0;                         ///< of a suture, that it was at
};

/// Rules of scoring.
struct ScoreConfig {
  double success_radius_m = 0.003;
  double hold_s = 5.0;
  double success_heading_deg = 15.0;
  double completion_window_s = 3.0;
  double success_completion = 0.95;
  double stitch_radius_m = 0.001;
  double stitch_heading_deg = 8.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("success_radius_m", success_radius_m, "m", "distance that counts as reached", {1e-5, 1.0});
    v.field("success_heading_deg", success_heading_deg, "deg",
            "heading error that counts as reached (task pose), and largest heading RMS along a path that has "
            "headings",
            {0.1, 180.0});
    v.field("hold_s", hold_s, "s",
            "the error while holding is the mean over this long at the end, from the first "
            "time within the success radius on",
            {0.0, 3600.0});
    v.field("completion_window_s", completion_window_s, "s",
            "a point of a path counts as reached only within so long before or after its time",
            {0.0, 3600.0});
    v.field("success_completion", success_completion, "", "share of a path's points that must be reached",
            {0.0, 1.0});
    v.field("stitch_radius_m", stitch_radius_m, "m",
            "a stitch is made where the needle goes in and comes out this near to its two ends (task suture)",
            {1e-5, 0.1});
    v.field("stitch_heading_deg", stitch_heading_deg, "deg", "and this near to the heading of each",
            {0.1, 180.0});
  }
};

/// Scores a run to a fixed point: reached where the last distance is within the radius. `samples` holds at
/// least one; the last one closes the run.
runs::TrialFigures score_point(const std::vector<ScoredSample>& samples, const ScoreConfig& config);

/// Scores a run along a path, to the end of its schedule; samples of the approach are left out, and at least
/// one is not. The reference's points are the targets of the samples. Success: enough of them reached (see
/// completion()), every corner approached to within the radius, and the cross-track RMS within it, so that
/// neither a needle that lies still nor one that comes late or cuts corners succeeds. Where the samples have
/// target headings, the heading's RMS error against them, moment by moment, must be within
/// `success_heading_deg`, too.
runs::TrialFigures score_path(const std::vector<ScoredSample>& samples, const geometry::Path& path,
                              const ScoreConfig& config);

/// Share of the reference's points that the needle came within the radius of, each within the window around
/// its time and none before one that it comes after: the largest share for which there are such moments.
/// Moments may serve several points.
double completion(const std::vector<ScoredSample>& samples, const ScoreConfig& config);

/// How near the needle came to a zone that it must keep out of, by its distances from the nearest one at one
/// moment after another (infinite: there was none), and how often it came to touch one, which is no success.
/// Without any zone nothing is noted.
void score_keep_out(const std::vector<double>& clearances_m, runs::TrialFigures& score);

/// Throws LogicFault when there are no trials.
runs::ErrorStatistics summarise_trials(const std::vector<const runs::TrialFigures*>& trials);
/// One task by one controller; the trials need not hold their trajectories any more.
runs::TaskSummary summarise_task(const std::vector<runs::TrialRecord>& trials);

}  // namespace lodestone::experiments
