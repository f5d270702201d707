#include "dish_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "dish_edges.h"

#include "lodestone/geometry/angle.h"

namespace lodestone::imaging {
namespace {

constexpr double kScaleRange = 0.08;  ///< of the dish's size in the image, either way
constexpr double kScaleStep = 0.005;
constexpr double kTurnRange_deg = 44.0;  ///< the bench looks the same every 90 degrees
constexpr double kTurnStep_deg = 0.5;
constexpr float kSoftContrast = 2.0F;  ///< grey levels per pixel from which an edge counts fully
constexpr int kSearchPointsPerCircle = 48;
constexpr int kSearchPointsPerLine = 12;

using Pose = Eigen::Matrix<double, 6, 1>;  ///< turn about x, y, z (rad) and shift (m), for moved()

CameraModel posed(const CameraModel& start, const Pose& pose) {
  return moved(start, pose.head<3>(), pose.tail<3>());
}

/// Gradients of `grey`, their length squeezed into [0, 1).
cv::Mat_<cv::Vec2f> soft_gradients(const cv::Mat_<float>& grey, double blur_px) {
  cv::Mat smooth;
  cv::Mat du;
  cv::Mat dv;
  cv::GaussianBlur(grey, smooth, {}, blur_px);
  cv::Sobel(smooth, du, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, dv, CV_32F, 0, 1, 3, 0.125);
  cv::Mat_<cv::Vec2f> gradients(grey.size());
  for (int v = 0; v < grey.rows; ++v) {
    const float* a = du.ptr<float>(v);
    const float* b = dv.ptr<float>(v);
    cv::Vec2f* out = gradients[v];
    for (int u = 0; u < grey.cols; ++u) {
      const float soft = 1.0F / (std::sqrt(a[u] * a[u] + b[u] * b[u]) + kSoftContrast);
      out[u] = {soft * a[u], soft * b[u]};
    }
  }
  return gradients;
}

double rim_radius_px(const CameraModel& camera, const BenchGeometry& bench) {
  const Eigen::Vector3d centre(0.0, 0.0, bench.wall_height_m);
  return (camera.project(centre + Eigen::Vector3d(bench.dish_radius_m, 0.0, 0.0)) -
          camera.project(centre - Eigen::Vector3d(bench.dish_radius_m, 0.0, 0.0)))
             .norm() /
         2.0;
}

/// Where most gradients point to from the distance of the rim, in pixels of the whole image.
Eigen::Vector2d vote_for_centre(const cv::Mat_<float>& grey, double radius_px) {
  constexpr double kShrink = 4.0;
  constexpr float kLeast = 0.5F;
  constexpr double kSpread_px = 2.5;
  cv::Mat small;
  cv::resize(grey, small, {}, 1.0 / kShrink, 1.0 / kShrink, cv::INTER_AREA);
  const cv::Mat_<cv::Vec2f> gradients = soft_gradients(small, 1.0);
  cv::Mat_<float> votes = cv::Mat_<float>::zeros(small.size());
  const double low = (1.0 - kScaleRange) * radius_px / kShrink;
  const double high = (1.0 + kScaleRange) * radius_px / kShrink;
  for (int v = 0; v < small.rows; ++v) {
    for (int u = 0; u < small.cols; ++u) {
      const cv::Vec2f g = gradients(v, u);
      const float strength = std::sqrt(g.dot(g));
      if (strength < kLeast) continue;
      for (const double side : {-1.0, 1.0}) {
        for (double r = low; r <= high; r += 1.0) {
          const int x = static_cast<int>(std::lround(u + side * r * g[0] / strength));
          const int y = static_cast<int>(std::lround(v + side * r * g[1] / strength));
          if (x >= 0 && y >= 0 && x < votes.cols && y < votes.rows) votes(y, x) += 1.0F;
        }
      }
    }
  }
  cv::GaussianBlur(votes, votes, {}, kSpread_px);
  cv::Point peak;
  cv::minMaxLoc(votes, nullptr, nullptr, nullptr, &peak);
  return {kShrink * (peak.x + 0.5) - 0.5, kShrink * (peak.y + 0.5) - 0.5};
}

/// How well the gradients of an image fit a pose.
class Score {
 public:
  Score(const cv::Mat_<float>& grey, const BenchGeometry& bench, const CameraModel& start)
      : bench_(bench), start_(start), edges_(edges_of(bench, kSearchPointsPerCircle, kSearchPointsPerLine)) {
    cv::Mat half;
    cv::resize(grey, half, {}, 0.5, 0.5, cv::INTER_AREA);
    gradients_ = soft_gradients(half, 1.5);
  }

  /// Sum over parts of edges of the coherent contrast across them: a part whose contrast changes sign does
  /// not count, so that texture and noise average out.
  double operator()(const Pose& pose, bool circles, bool lines) const {
    const CameraModel camera = posed(start_, pose);
    const Visibility visible(camera, bench_);
    std::array<std::array<double, kParts>, kEdgeKinds> sums{};
    for (const EdgePoint& edge : edges_) {
      if (is_circle(edge.kind) ? !circles : !lines) continue;
      const SeenEdge seen = see(camera, edge);
      if (!visible(edge, seen.pixel, 4.0)) continue;
      const cv::Vec2f g =
          gradients_(static_cast<int>(0.5 * seen.pixel.y()), static_cast<int>(0.5 * seen.pixel.x()));
      sums[edge.kind][static_cast<std::size_t>(edge.part)] += seen.normal.x() * g[0] + seen.normal.y() * g[1];
    }
    double total = 0.0;
    for (const auto& kind : sums)
      for (const double sum : kind) total += std::abs(sum);
    return total;
  }

 private:
  BenchGeometry bench_;
  CameraModel start_;
  std::vector<EdgePoint> edges_;
  cv::Mat_<cv::Vec2f> gradients_;
};

/// Walks along each axis in turn while the score grows, with ever smaller steps.
void climb(const Score& score, bool lines, const Pose& first_step, int halvings, Pose& pose) {
  double best = score(pose, true, lines);
  Pose step = first_step;
  for (int level = 0; level <= halvings; ++level, step *= 0.5) {
    bool better = true;
    for (int sweep = 0; better && sweep < 6; ++sweep) {
      better = false;
      for (int axis = 0; axis < 6; ++axis) {
        if (step(axis) == 0.0) continue;
        for (const double direction : {-1.0, 1.0}) {
          Pose trial = pose;
          trial(axis) += direction * step(axis);
          const double value = score(trial, true, lines);
          if (value <= best) continue;
          best = value;
          pose = trial;
          better = true;
          break;
        }
      }
    }
  }
}

/// Size of the dish in the image, with its centre near that of `pose`.
void scan_size(const Score& score, double distance_m, double pixel_m, Pose& pose) {
  const Pose from = pose;
  double best = -1.0;
  for (double scale = -kScaleRange; scale <= kScaleRange; scale += kScaleStep) {
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        Pose trial = from;
        trial.tail<3>() += Eigen::Vector3d(4.0 * i * pixel_m, 4.0 * j * pixel_m, scale * distance_m);
        const double value = score(trial, true, false);
        if (value <= best) continue;
        best = value;
        pose = trial;
      }
    }
  }
}

void scan_turn(const Score& score, Pose& pose) {
  const Pose from = pose;
  double best = -1.0;
  for (double turn = -kTurnRange_deg; turn <= kTurnRange_deg; turn += kTurnStep_deg) {
    Pose trial = from;
    trial(2) += geometry::kRadPerDeg * turn;
    const double value = score(trial, false, true);
    if (value <= best) continue;
    best = value;
    pose = trial;
  }
}

}  // namespace

CameraModel search_dish(const cv::Mat_<float>& grey, const BenchGeometry& bench, const CameraModel& start) {
  const double pixel_m = start.pixel_size_m();
  const double distance_m = start.translation_m.z();
  const Eigen::Vector2d centre = vote_for_centre(grey, rim_radius_px(start, bench));
  const Score score(grey, bench, start);
  Pose pose = Pose::Zero();
  pose.segment<2>(3) = -start.to_dish(centre, 0.5 * bench.wall_height_m);
  scan_size(score, distance_m, pixel_m, pose);
  Pose step;
  step << 2.0 * geometry::kRadPerDeg, 2.0 * geometry::kRadPerDeg, 0.0, 4.0 * pixel_m, 4.0 * pixel_m,
      kScaleStep * distance_m;
  climb(score, false, step, 2, pose);
  scan_turn(score, pose);
  step(2) = kTurnStep_deg * geometry::kRadPerDeg;
  climb(score, true, step, 3, pose);
  return posed(start, pose);
}

}  // namespace lodestone::imaging
