#include "lodestone/experiments/suture_score.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {
namespace {

using geometry::Pose2;
using geometry::Vector2;

/// A moment of a run: after so many samples and a share of the step to the next one.
struct Moment {
  std::size_t sample = 0;
  double share = 0.0;
  double distance_m = 0.0;  ///< from what it is nearest to
};

/// What a needle was pushed through, sample by sample.
class Push {
 public:
  explicit Push(std::vector<Pose2> poses) : poses_(std::move(poses)) {}

  /// The first moment from `since` on at which the needle was nearest to a point.
  Moment nearest(const Vector2& point_m, const Moment& since) const {
    Moment best = since;
    best.distance_m = (at(since).position_m() - point_m).norm();
    for (std::size_t i = since.sample; i + 1 < poses_.size(); ++i) {
      const Vector2 from_m = poses_[i].position_m();
      const Vector2 step_m = poses_[i + 1].position_m() - from_m;
      const double least = i == since.sample ? since.share : 0.0;
      const double square = step_m.squaredNorm();
      const double share =
          square > 0.0 ? std::clamp((point_m - from_m).dot(step_m) / square, least, 1.0) : least;
      const double distance_m = (from_m + share * step_m - point_m).norm();
      if (distance_m < best.distance_m) best = {i, share, distance_m};
    }
    return best;
  }

  double heading_rad(const Moment& moment) const { return at(moment).heading_rad; }

 private:
  Pose2 at(const Moment& moment) const {
    const Pose2& from = poses_[moment.sample];
    if (moment.sample + 1 >= poses_.size()) return from;
    const Pose2& to = poses_[moment.sample + 1];
    const Vector2 point_m = from.position_m() + moment.share * (to.position_m() - from.position_m());
    return {point_m.x(), point_m.y(),
            from.heading_rad + moment.share * geometry::wrap_angle(to.heading_rad - from.heading_rad)};
  }

  std::vector<Pose2> poses_;
};

Push push_through(const std::vector<ScoredSample>& samples, std::size_t stitch) {
  std::vector<Pose2> poses;
  for (const ScoredSample& sample : samples)
    if (!sample.approach && sample.stitch == stitch)
      poses.push_back({sample.position_m.x(), sample.position_m.y(), sample.heading_rad});
  LODESTONE_CHECK(!poses.empty(), "a sample at which stitch " + std::to_string(stitch) + " was made");
  return Push(std::move(poses));
}

double off_deg(double heading_rad, double wanted_rad) {
  return geometry::kDegPerRad * std::abs(geometry::wrap_angle(heading_rad - wanted_rad));
}

runs::StitchFigures score_stitch(const Push& push, const geometry::Stitch& stitch,
                                 const ScoreConfig& config) {
  const Moment in = push.nearest(stitch.entry.position_m(), {});
  const Moment out = push.nearest(stitch.exit.position_m(), in);
  runs::StitchFigures figures;
  figures.entry_error_mm = geometry::kMmPerM * in.distance_m;
  figures.entry_heading_deg = off_deg(push.heading_rad(in), stitch.entry.heading_rad);
  figures.exit_error_mm = geometry::kMmPerM * out.distance_m;
  figures.exit_heading_deg = off_deg(push.heading_rad(out), stitch.exit.heading_rad);
  figures.made = std::max(in.distance_m, out.distance_m) <= config.stitch_radius_m &&
                 std::max(figures.entry_heading_deg, figures.exit_heading_deg) <= config.stitch_heading_deg;
  return figures;
}

/// Against the moving target, of all samples that are scored.
double pushed_heading_rms_deg(const std::vector<ScoredSample>& samples) {
  std::vector<double> errors_deg;
  for (const ScoredSample& sample : samples)
    if (!sample.approach && sample.target_heading_rad)
      errors_deg.push_back(off_deg(sample.heading_rad, *sample.target_heading_rad));
  LODESTONE_CHECK(!errors_deg.empty(), "a heading that was wanted");
  return common::root_mean_square(errors_deg);
}

}  // namespace

runs::TrialFigures score_suture(const std::vector<ScoredSample>& samples,
                                const std::vector<geometry::Stitch>& stitches, const ScoreConfig& config) {
  LODESTONE_CHECK(!samples.empty() && !stitches.empty(), "samples and stitches to score");
  runs::TrialFigures score;
  score.final_error_mm = geometry::kMmPerM * (samples.back().position_m - samples.back().target_m).norm();
  score.heading_rms_deg = pushed_heading_rms_deg(samples);
  score.stitches_made = 0;
  score.stitch_figures.emplace();
  std::vector<double> errors_mm, headings_deg;
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    const runs::StitchFigures figures = score_stitch(push_through(samples, i), stitches[i], config);
    if (figures.made) ++*score.stitches_made;
    errors_mm.insert(errors_mm.end(), {figures.entry_error_mm, figures.exit_error_mm});
    headings_deg.insert(headings_deg.end(), {figures.entry_heading_deg, figures.exit_heading_deg});
    score.stitch_figures->push_back(figures);
  }
  score.stitches_made_share =
      static_cast<double>(*score.stitches_made) / static_cast<double>(stitches.size());
  score.stitch_rms_mm = common::root_mean_square(errors_mm);
  score.stitch_worst_mm = *std::max_element(errors_mm.begin(), errors_mm.end());
  score.stitch_worst_deg = *std::max_element(headings_deg.begin(), headings_deg.end());
  score.success = *score.stitches_made == static_cast<std::int64_t>(stitches.size());
  return score;
}

}  // namespace lodestone::experiments
