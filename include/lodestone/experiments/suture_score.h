#pragma once

#include <vector>

#include "lodestone/experiments/score.h"
#include "lodestone/geometry/stitch.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::experiments {

/// Scores a run through stitches, to the end of its schedule; samples of the approach to a stitch are left
/// out, and every stitch has at least one that is not. Of a stitch count the moment at which the needle,
/// pushed through it, is nearest to the entry, and the one from there on at which it is nearest to the exit;
/// between two samples it goes and turns evenly. It is made where both are within `stitch_radius_m` and
/// `stitch_heading_deg`. Success: all are made. The heading's RMS error is that against the moving target.
runs::TrialFigures score_suture(const std::vector<ScoredSample>& samples,
                                const std::vector<geometry::Stitch>& stitches, const ScoreConfig& config);

}  // namespace lodestone::experiments
