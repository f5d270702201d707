#include "lodestone/imaging/rim_watch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "dish_edges.h"
#include "lodestone/common/statistics.h"

namespace lodestone::imaging {
namespace {

constexpr int kWatchedPerCircle = 72;
constexpr int kWatchedPerLine = 16;
constexpr double kWatchReach_px = 10.0;
constexpr double kWatchContrast = 1.5;  // grey levels per pixel
constexpr double kLeastSeen = 0.4;      // of the edges
constexpr double kLargestRms_px = 1.0;  // of those that agree
constexpr double kOutlier = 4.685;      // Tukey's, of the scatter
constexpr double kLeastScatter_px = 0.1;
constexpr int kFits = 5;

/// A shift of the image (px), a turn (rad) and a change of scale about the dish centre.
using Motion = Eigen::Vector4d;
/// A turn shows only where coils are in view, and is none where they are not.
const Motion kMotionSigma(50.0, 50.0, 0.02, 0.02);

}  // namespace

struct RimWatch::State {
  struct Watched {
    SeenEdge seen;
    std::size_t group;          // of edges that look alike
    double reach_px;            // further away there is another edge
    Eigen::Vector4d by_motion;  // what a motion does across the edge
  };
  struct Hit {
    const Watched* edge;
    double offset_px;
  };

  State(const Calibration& calibration, const BenchGeometry& bench)
      : pixel_m(calibration.camera.pixel_size_m()), radius_m(bench.dish_radius_m) {
    const CameraModel& camera = calibration.camera;
    const Eigen::Vector2d centre = camera.project(Eigen::Vector3d::Zero());
    const Visibility visible(camera, bench);
    for (const EdgePoint& edge : edges_of(bench, kWatchedPerCircle, kWatchedPerLine)) {
      if (edge.kind == kFloor) continue;
      const SeenEdge seen = see(camera, edge);
      if (!visible(edge, seen.pixel, kWatchReach_px + 5.0)) continue;
      // The other edge of a narrow bore is as strong as the base line, and of the other sign: learned from
      // it, the line would be seen beside its place ever after.
      const double room_px = visible.room_px(edge);
      if (!is_circle(edge.kind) && room_px < kApart_px) continue;
      const Eigen::Vector2d from_centre = seen.pixel - centre;
      const double turned = seen.normal.dot(Eigen::Vector2d(-from_centre.y(), from_centre.x()));
      watched.push_back({seen,
                         static_cast<std::size_t>(edge.kind) * kParts + static_cast<std::size_t>(edge.part),
                         reach_within_px(room_px, kWatchReach_px),
                         {seen.normal.x(), seen.normal.y(), turned, seen.normal.dot(from_centre)}});
    }
  }

  std::vector<Hit> hits(const cv::Mat_<float>& grey) const {
    std::vector<Hit> found;
    for (const Watched& edge : watched) {
      const EdgeHit hit =
          find_edge(grey, edge.seen, edge.reach_px, signs[edge.group] < 0.0 ? -1.0 : 1.0, kWatchContrast);
      if (hit.found) found.push_back({&edge, hit.offset_px});
    }
    return found;
  }

  void learn(const cv::Mat_<float>& grey) {
    signs.fill(0.0);
    for (const Watched& edge : watched)
      for (const double sign : {-1.0, 1.0}) {
        const EdgeHit hit = find_edge(grey, edge.seen, edge.reach_px, sign, kWatchContrast);
        if (hit.found) signs[edge.group] += hit.contrast;
      }
  }

  bool enough(std::size_t count) const {
    return static_cast<double>(count) >= kLeastSeen * static_cast<double>(watched.size());
  }

  /// By robust least squares; nothing where too few edges agree.
  std::optional<Motion> motion(const std::vector<Hit>& found) const {
    Motion motion = Motion::Zero();
    std::vector<double> away(found.size());
    for (int fit = 0; fit <= kFits; ++fit) {
      for (std::size_t i = 0; i < found.size(); ++i)
        away[i] = found[i].offset_px - found[i].edge->by_motion.dot(motion);
      std::vector<double> sizes(away.size());
      std::transform(away.begin(), away.end(), sizes.begin(), [](double size) { return std::abs(size); });
      const double scatter_px = std::max(1.4826 * common::median(sizes), kLeastScatter_px);
      Eigen::Matrix4d normal = kMotionSigma.cwiseAbs2().cwiseInverse().asDiagonal();
      Motion right = Motion::Zero();
      double squares = 0.0;
      std::size_t agreed = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        // At first all of them: of a turn the rim, which is most of them, knows nothing.
        const double ratio = fit == 0 ? 0.0 : away[i] / (kOutlier * scatter_px);
        if (std::abs(ratio) >= 1.0) continue;
        const double weight = (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
        const Eigen::Vector4d& slope = found[i].edge->by_motion;
        normal += weight * slope * slope.transpose();
        right += weight * found[i].offset_px * slope;
        squares += away[i] * away[i];
        ++agreed;
      }
      if (!enough(agreed)) return std::nullopt;
      if (fit < kFits)
        motion = normal.ldlt().solve(right);
      else if (std::sqrt(squares / static_cast<double>(agreed)) > kLargestRms_px)
        return std::nullopt;
    }
    return motion;
  }

  double pixel_m;
  double radius_m;
  std::vector<Watched> watched;
  std::array<double, kEdgeKinds * kParts> signs{};
  bool known = false;
};

RimWatch::RimWatch(const Calibration& calibration, const BenchGeometry& bench)
    : state_(std::make_unique<State>(calibration, bench)) {}
RimWatch::~RimWatch() = default;
RimWatch::RimWatch(RimWatch&&) noexcept = default;
RimWatch& RimWatch::operator=(RimWatch&&) noexcept = default;

std::optional<double> RimWatch::moved_m(const cv::Mat& image) {
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  cv::Mat_<float> levels;
  grey.convertTo(levels, CV_32F);
  if (!state_->known) state_->learn(levels);
  const std::vector<State::Hit> found = state_->hits(levels);
  if (found.empty() || !state_->enough(found.size())) return std::nullopt;
  const std::optional<Motion> motion = state_->motion(found);
  if (!motion) return std::nullopt;
  state_->known = true;
  // Of a point of the floor, whose mean squared distance from the centre is half of that of the wall.
  const double shift_m = state_->pixel_m * motion->head<2>().norm();
  return std::hypot(shift_m, state_->radius_m * std::sqrt(0.5) * motion->tail<2>().norm());
}

}  // namespace lodestone::imaging
