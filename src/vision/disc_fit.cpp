#include "lodestone/vision/disc_fit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodestone/geometry/angle.h"

namespace lodestone::vision {

namespace {

using geometry::Vector2;

constexpr int kDiscRefinements = 4;
constexpr double kLargestDisc = 3.0;  // in areas of the sphere: a cluster of more is something else
constexpr float kDiscFloor = -3.0F;   // log-odds below which a pixel is none of it

double disc_probability(float log_odds) { return 1.0 / (1.0 + std::exp(-static_cast<double>(log_odds))); }

/// Mean place and sum of the probabilities within a distance.
struct DiscSum {
  Vector2 place_m = Vector2::Zero();
  double probability = 0.0;
  int pixels = 0;
};

class DiscFitter {
 public:
  DiscFitter(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config)
      : evidence_(evidence),
        grid_(grid),
        config_(config),
        radius_m_(0.5 * config.needle_diameter_m),
        disc_pixels_(geometry::kPi * std::pow(radius_m_ / grid.pixel_m, 2)) {}

  RodFit fit() const {
    RodFit found;
    for (const Vector2& start_m : clusters()) {
      const Rod disc = disc_at(start_m);
      if (disc.support < config_.min_support) continue;
      // Two parts of one disc, with something across it, are one.
      const bool known = std::any_of(found.candidates.begin(), found.candidates.end(), [&](const Rod& other) {
        return (other.pose.position_m() - disc.pose.position_m()).norm() < radius_m_;
      });
      if (!known) found.candidates.push_back(disc);
    }
    if (found.candidates.size() == 1) static_cast<Rod&>(found) = found.candidates.front();
    if (found.candidates.empty()) found.reason = "no sphere in view";
    if (found.candidates.size() > 1) found.reason = "more than one sphere in view, or something like one";
    return found;
  }

 private:
  /// Middles of the connected parts of the mask that are neither too small nor too large for a sphere.
  std::vector<Vector2> clusters() const {
    const cv::Mat mask = evidence_.needle > 0.0F;
    cv::Mat labels, stats, centroids;
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
    std::vector<Vector2> middles_m;
    for (int label = 1; label < count; ++label) {
      const double pixels = stats.at<int>(label, cv::CC_STAT_AREA);
      if (pixels < config_.min_visible * disc_pixels_ || pixels > kLargestDisc * disc_pixels_) continue;
      middles_m.push_back(grid_.at(centroids.at<double>(label, 0), centroids.at<double>(label, 1)));
    }
    return middles_m;
  }

  DiscSum sum_within(const Vector2& middle_m, double reach_m) const {
    const double column = (middle_m.x() - grid_.first_m.x()) / grid_.pixel_m;
    const double row = (grid_.first_m.y() - middle_m.y()) / grid_.pixel_m;
    const int reach = static_cast<int>(reach_m / grid_.pixel_m) + 1;
    const int first_row = std::max(0, static_cast<int>(row) - reach);
    const int last_row = std::min(evidence_.needle.rows - 1, static_cast<int>(row) + reach + 1);
    const int first_column = std::max(0, static_cast<int>(column) - reach);
    const int last_column = std::min(evidence_.needle.cols - 1, static_cast<int>(column) + reach + 1);
    DiscSum sum;
    for (int r = first_row; r <= last_row; ++r) {
      const auto* values = evidence_.needle.ptr<float>(r);
      for (int c = first_column; c <= last_column; ++c) {
        const Vector2 at_m = grid_.at(c, r);
        if ((at_m - middle_m).norm() > reach_m) continue;
        ++sum.pixels;
        if (values[c] < kDiscFloor) continue;
        const double probability = disc_probability(values[c]);
        sum.place_m += probability * at_m;
        sum.probability += probability;
      }
    }
    if (sum.probability > 0.0) sum.place_m /= sum.probability;
    return sum;
  }

  Rod disc_at(Vector2 middle_m) const {
    for (int step = 0; step < kDiscRefinements; ++step) {
      const DiscSum near = sum_within(middle_m, radius_m_ + 1.5 * grid_.pixel_m);
      if (near.probability > 0.0) middle_m = near.place_m;
    }
    const DiscSum core = sum_within(middle_m, std::max(radius_m_ - 0.5 * grid_.pixel_m, grid_.pixel_m));
    Rod disc;
    disc.found = disc.axis_found = true;
    disc.head_certainty = 1.0;
    disc.support = core.pixels > 0 ? core.probability / core.pixels : 0.0;
    disc.pose = {middle_m.x(), middle_m.y(), 0.0};
    // Each pixel of the edge is in or out, which errs by a twelfth of a pixel squared, radially.
    const double radius_px = radius_m_ / grid_.pixel_m;
    const double variance_m2 = config_.sigma_scale * config_.sigma_scale * grid_.pixel_m * grid_.pixel_m /
                               (12.0 * geometry::kPi * radius_px);
    disc.covariance.diagonal() << variance_m2, variance_m2, 0.0;
    return disc;
  }

  const Evidence& evidence_;
  const MaskGrid& grid_;
  const RodConfig& config_;
  double radius_m_;
  double disc_pixels_;
};

}  // namespace

RodFit fit_disc(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config) {
  return DiscFitter(evidence, grid, config).fit();
}

}  // namespace lodestone::vision
