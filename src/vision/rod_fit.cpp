#include "lodestone/vision/rod_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/vision/disc_fit.h"

namespace lodestone::vision {

namespace {

using geometry::Vector2;

constexpr int kTrials = 96;  ///< of RANSAC
constexpr int kRefinements = 5;
constexpr int kMostRods = 4;  ///< lines that are tried
// A second needle is suspected sooner than a first is believed.
constexpr double kSuspectSupport = 0.42;
constexpr double kSuspectVisible = 0.2;
constexpr double kProfileStep_m = 0.1e-3;
constexpr float kMaxLogOdds = 5.0F;  ///< a pixel says no more than this
constexpr int kMinClusterPixels = 3;

struct MaskPoint {
  Vector2 at_m;
  double weight;  ///< probability of being needle
};

double probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

struct Line {
  Vector2 centre_m = Vector2::Zero();
  double angle_rad = 0.0;

  Vector2 along() const { return {std::cos(angle_rad), std::sin(angle_rad)}; }
  Vector2 across() const { return {-std::sin(angle_rad), std::cos(angle_rad)}; }
};

/// Between pixels; outside the mask there is no needle.
float log_odds_at(const cv::Mat& map, double column, double row) {
  const int c = static_cast<int>(std::floor(column));
  const int r = static_cast<int>(std::floor(row));
  if (c < 0 || r < 0 || c + 1 >= map.cols || r + 1 >= map.rows) return -kMaxLogOdds;
  const auto fc = static_cast<float>(column - c);
  const auto fr = static_cast<float>(row - r);
  const auto clipped = [&](int rr, int cc) {
    return std::clamp(map.at<float>(rr, cc), -kMaxLogOdds, kMaxLogOdds);
  };
  return (1.0F - fr) * ((1.0F - fc) * clipped(r, c) + fc * clipped(r, c + 1)) +
         fr * ((1.0F - fc) * clipped(r + 1, c) + fc * clipped(r + 1, c + 1));
}

class RodFitter {
 public:
  RodFitter(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config)
      : evidence_(evidence),
        grid_(grid),
        config_(config),
        needle_pixels_(config.needle_length_m * config.needle_diameter_m / (grid.pixel_m * grid.pixel_m)) {}

  RodFit fit() {
    find_clusters();
    if (static_cast<double>(points_.size()) < config_.min_visible * needle_pixels_)
      return nothing("no needle in view");
    const std::vector<Line> rods = find_rods();
    if (rods.empty()) return nothing("no needle in view: what is there is no straight rod");
    RodFit found;
    if (rods.size() > 1) found.reason = "more than one needle in view, or something like one";
    for (const Line& line : rods) found.candidates.push_back(rod_of(line));
    if (rods.size() == 1) static_cast<Rod&>(found) = found.candidates.front();
    return found;
  }

 private:
  static RodFit nothing(const std::string& reason) {
    RodFit none;
    none.reason = reason;
    return none;
  }

  Rod rod_of(Line line) {
    refine(line);  // once more, so that weight and spread are this line's
    Rod rod;
    rod.support = support(line);
    find_head(line, rod);
    rod.axis_found = true;
    rod.found = rod.head_certainty >= config_.min_head_certainty;
    if (!rod.found) rod.reason = "head and tail cannot be told apart: the tape is not seen";
    rod.pose = {line.centre_m.x(), line.centre_m.y(), geometry::wrap_angle(line.angle_rad)};
    rod.covariance = covariance(line);
    return rod;
  }

  /// Connected parts of the mask; specks are dropped.
  void find_clusters() {
    const cv::Mat mask = evidence_.needle > 0.0F;
    cv::Mat labels;
    cv::Mat stats;
    cv::Mat centroids;
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
    if (count <= 1) return;
    for (int row = 0; row < labels.rows; ++row) {
      const int* label = labels.ptr<int>(row);
      for (int column = 0; column < labels.cols; ++column) {
        if (label[column] == 0 || stats.at<int>(label[column], cv::CC_STAT_AREA) < kMinClusterPixels)
          continue;
        points_.push_back({grid_.at(column, row), probability(evidence_.needle.at<float>(row, column))});
      }
    }
  }

  /// Straight rods of the needle's length, one after the other: what a line explains is taken away before the
  /// next is looked for. Threads and stains that the network took for needle leave lines without support.
  std::vector<Line> find_rods() {
    std::vector<Line> rods;
    for (int i = 0; i < kMostRods; ++i) {
      const double needed = rods.empty() ? config_.min_visible : kSuspectVisible;
      if (static_cast<double>(points_.size()) < needed * needle_pixels_) break;
      Line line = consensus();
      for (int step = 0; step < kRefinements; ++step) refine(line);
      if (support(line) >= (rods.empty() ? config_.min_support : kSuspectSupport)) rods.push_back(line);
      take_away(line);
    }
    return rods;
  }

  /// The line through two mask pixels that most others lie on, within one needle's length.
  Line consensus() const {
    common::RandomStream random(1, "ransac");
    const std::size_t n = points_.size();
    Line best;
    double best_score = -1.0;
    std::vector<double> bins;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Vector2& a = points_[random.below(n)].at_m;
      const Vector2 way = points_[random.below(n)].at_m - a;
      if (way.norm() < 0.08 * config_.needle_length_m) continue;
      Line line{a, std::atan2(way.y(), way.x())};
      const double score = window(line, bins);
      if (score > best_score) {
        best_score = score;
        best = line;
      }
    }
    return best;
  }

  /// Weight of the inliers in the best stretch of one needle's length; moves the line's centre there.
  double window(Line& line, std::vector<double>& bins) const {
    const double bin_m = 0.02 * config_.needle_length_m;
    constexpr int kHalf = 120;
    bins.assign(2 * kHalf + 1, 0.0);
    const Vector2 along = line.along();
    const Vector2 across = line.across();
    for (const MaskPoint& point : points_) {
      const Vector2 offset = point.at_m - line.centre_m;
      if (std::abs(across.dot(offset)) > config_.inlier_m) continue;
      const int bin = static_cast<int>(std::lround(along.dot(offset) / bin_m)) + kHalf;
      if (bin >= 0 && bin < static_cast<int>(bins.size()))
        bins[static_cast<std::size_t>(bin)] += point.weight;
    }
    constexpr int kWindow = 51;
    double sum = 0.0;
    double best = -1.0;
    int best_end = 0;
    for (int end = 0; end < static_cast<int>(bins.size()); ++end) {
      sum += bins[static_cast<std::size_t>(end)];
      if (end >= kWindow) sum -= bins[static_cast<std::size_t>(end - kWindow)];
      if (sum > best) {
        best = sum;
        best_end = end;
      }
    }
    line.centre_m += bin_m * (best_end - kWindow / 2 - kHalf) * along;
    return best;
  }

  /// Regression across the line, then the best place along it.
  void refine(Line& line) {
    const Vector2 along = line.along();
    const Vector2 across = line.across();
    const double reach_m = 0.5 * config_.needle_length_m;
    double w = 0.0, ws = 0.0, wss = 0.0, wd = 0.0, wsd = 0.0;
    visit_near(line, [&](double s, double d, double weight) {
      if (std::abs(s) > reach_m) return;
      w += weight;
      ws += weight * s;
      wss += weight * s * s;
      wd += weight * d;
      wsd += weight * s * d;
    });
    const double determinant = w * wss - ws * ws;
    if (determinant > 0.0) {
      const double slope = (w * wsd - ws * wd) / determinant;
      const double offset = (wd - slope * ws) / w;
      line.centre_m += offset * across;
      line.angle_rad += std::atan(slope);
      weight_ = w;
      spread_m2_ = wss / w - (ws / w) * (ws / w);
    }
    line.centre_m += best_shift(line) * along;
  }

  /// Calls body(s, d, probability) for pixels beside the line: along it, across it, in metres.
  template <class Body>
  void visit_near(const Line& line, const Body& body) const {
    const Vector2 along = line.along();
    const Vector2 across = line.across();
    const double reach_m = 0.5 * config_.needle_length_m + 2.0 * grid_.pixel_m;
    const double side_m = 0.5 * config_.needle_diameter_m + 1.5 * grid_.pixel_m;
    const double column = (line.centre_m.x() - grid_.first_m.x()) / grid_.pixel_m;
    const double row = (grid_.first_m.y() - line.centre_m.y()) / grid_.pixel_m;
    const int reach = static_cast<int>((reach_m + side_m) / grid_.pixel_m) + 1;
    const int first_row = std::max(0, static_cast<int>(row) - reach);
    const int last_row = std::min(evidence_.needle.rows - 1, static_cast<int>(row) + reach);
    const int first_column = std::max(0, static_cast<int>(column) - reach);
    const int last_column = std::min(evidence_.needle.cols - 1, static_cast<int>(column) + reach);
    for (int r = first_row; r <= last_row; ++r) {
      const auto* values = evidence_.needle.ptr<float>(r);
      for (int c = first_column; c <= last_column; ++c) {
        if (values[c] < -3.0F) continue;
        const Vector2 offset = grid_.at(c, r) - line.centre_m;
        const double s = along.dot(offset);
        const double d = across.dot(offset);
        if (std::abs(s) <= reach_m && std::abs(d) <= side_m) body(s, d, probability(values[c]));
      }
    }
  }

  /// Mean log-odds over the needle's core at `s_m` along the line.
  float core(const cv::Mat& map, const Line& line, double s_m) const {
    const double side_m = 0.25 * config_.needle_diameter_m;
    float sum = 0.0F;
    for (const double d_m : {-side_m, 0.0, side_m}) {
      const Vector2 at = line.centre_m + s_m * line.along() + d_m * line.across();
      sum += log_odds_at(map, (at.x() - grid_.first_m.x()) / grid_.pixel_m,
                         (grid_.first_m.y() - at.y()) / grid_.pixel_m);
    }
    return sum / 3.0F;
  }

  /// Where along the line a rod of the needle's length has the highest sum of log-odds: each end of it then
  /// lies where the log-odds are equal, and a hidden end gives way to a visible one.
  double best_shift(const Line& line) {
    const int half = static_cast<int>(std::lround(0.5 * config_.needle_length_m / kProfileStep_m));
    const int slack = static_cast<int>(std::lround(0.45 * config_.needle_length_m / kProfileStep_m));
    const int reach = half + slack;
    std::vector<double> sums(static_cast<std::size_t>(2 * reach + 2), 0.0);
    for (int i = -reach; i <= reach; ++i)
      sums[static_cast<std::size_t>(i + reach + 1)] =
          sums[static_cast<std::size_t>(i + reach)] + core(evidence_.needle, line, i * kProfileStep_m);
    const auto score = [&](int shift) {
      return sums[static_cast<std::size_t>(shift + half + reach + 1)] -
             sums[static_cast<std::size_t>(shift - half + reach)];
    };
    int best = 0;
    for (int shift = -slack; shift <= slack; ++shift) {
      if (score(shift) > score(best)) best = shift;
    }
    // A parabola through the scores a pixel away gives the place between steps, and how sharp the maximum is.
    const int side = std::max(1, static_cast<int>(std::lround(grid_.pixel_m / kProfileStep_m)));
    const auto at = [&](int shift) { return score(std::clamp(shift, -slack, slack)); };
    const double curvature = at(best + side) - 2.0 * at(best) + at(best - side);
    const double slope = 0.5 * (at(best + side) - at(best - side));
    const double between = curvature < 0.0 ? std::clamp(-slope / curvature, -1.0, 1.0) * side : 0.0;
    // Samples a pixel apart are independent; those in between repeat them.
    const double per_m2 =
        -curvature * (kProfileStep_m / grid_.pixel_m) / (side * kProfileStep_m * side * kProfileStep_m);
    const double worst_m = 0.25 * config_.needle_length_m;
    along_variance_m2_ = 1.0 / std::max(per_m2, 1.0 / (worst_m * worst_m));
    return (best + between) * kProfileStep_m;
  }

  double support(const Line& line) const {
    const int steps = static_cast<int>(config_.needle_length_m / kProfileStep_m);
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
      sum += probability(
          core(evidence_.needle, line, (i + 0.5) * kProfileStep_m - 0.5 * config_.needle_length_m));
    return sum / steps;
  }

  /// Drops the mask pixels that a line explains.
  void take_away(const Line& line) {
    const double side_m = 0.5 * config_.needle_diameter_m + 2.5 * grid_.pixel_m;
    const double reach_m = 0.5 * config_.needle_length_m + 4.0 * grid_.pixel_m;
    const auto explained = [&](const MaskPoint& point) {
      const Vector2 offset = point.at_m - line.centre_m;
      return std::abs(line.across().dot(offset)) <= side_m && std::abs(line.along().dot(offset)) <= reach_m;
    };
    points_.erase(std::remove_if(points_.begin(), points_.end(), explained), points_.end());
  }

  /// Turns the line so that it points to the head.
  void find_head(Line& line, Rod& rod) const {
    const auto mean = [&](double sign) {
      const int steps = static_cast<int>(0.9 * config_.tape_length_m / kProfileStep_m);
      double sum = 0.0;
      for (int i = 0; i < steps; ++i)
        sum += core(evidence_.tape, line, sign * (0.5 * config_.needle_length_m - (i + 1) * kProfileStep_m));
      return sum / std::max(steps, 1);
    };
    const double ahead = mean(1.0) - mean(-1.0);
    if (ahead < 0.0) line.angle_rad += geometry::kPi;
    rod.tape_log_odds = std::abs(ahead);
    rod.head_certainty = probability(rod.tape_log_odds);
  }

  Eigen::Matrix3d covariance(const Line& line) const {
    const double pixel_m2 = grid_.pixel_m * grid_.pixel_m;
    // A pixel's place across the line is known to about a third of a pixel; neighbours repeat each other.
    const double across_m2 = 0.3 * pixel_m2 / std::max(weight_, 1.0);
    const double heading_rad2 = across_m2 / std::max(spread_m2_, pixel_m2);
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    own.diagonal() << along_variance_m2_, across_m2, heading_rad2;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(line.angle_rad).toRotationMatrix();
    return config_.sigma_scale * config_.sigma_scale * turn * own * turn.transpose();
  }

  const Evidence& evidence_;
  const MaskGrid& grid_;
  const RodConfig& config_;
  double needle_pixels_;
  std::vector<MaskPoint> points_;
  double weight_ = 0.0;
  double spread_m2_ = 0.0;
  double along_variance_m2_ = 0.0;
};

}  // namespace

RodConfig rod_of(const imaging::BenchGeometry& bench, RodConfig config) {
  config.needle_length_m = bench.needle_length_m;
  config.needle_diameter_m = bench.needle_diameter_m;
  config.tape_length_m = bench.tape_length_m;
  config.sphere = bench.sphere;
  return config;
}

RodFit fit_rod(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config) {
  if (config.sphere) return fit_disc(evidence, grid, config);
  return RodFitter(evidence, grid, config).fit();
}

}  // namespace lodestone::vision
