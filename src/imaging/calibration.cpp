#include "lodestone/imaging/calibration.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "dish_edges.h"
#include "dish_search.h"
#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"

namespace lodestone::imaging {
namespace {

constexpr int kPointsPerCircle = 240;
constexpr int kPointsPerLine = 80;
constexpr double kLeastContrast = 1.5;  ///< grey levels per pixel
/// One after the other; the last ones settle the fit.
constexpr std::array<double, 6> kReach_px = {10.0, 6.0, 4.0, 3.0, 3.0, 3.0};
constexpr int kSteps = 3;                ///< of Gauss and Newton for one set of edges
constexpr double kTukey = 4.685;         ///< 95 % efficiency for normal errors
constexpr double kLeastScale_px = 0.05;  ///< errors below this are no outliers
/// Neighbouring points share their error, so that a point is worth less than its scatter says.
constexpr double kPointSigma_px = 0.5;
constexpr std::int64_t kLeastLinePoints = 20;

using Step = Eigen::Matrix<double, 8, 1>;  ///< turn (rad), shift (m), log of focal length, k1
constexpr std::array<double, 8> kProbe = {1e-5, 1e-5, 1e-5, 1e-6, 1e-6, 1e-6, 1e-5, 1e-3};

CameraModel stepped(const CameraModel& camera, const Step& step) {
  CameraModel out = moved(camera, step.head<3>(), step.segment<3>(3));
  out.focal_px *= std::exp(step(6));
  out.k1 += step(7);
  return out;
}

/// An edge that was found.
struct Found {
  const EdgePoint* edge;
  Eigen::Vector2d pixel;
  Eigen::Vector2d normal;
  double weight = 1.0;

  double residual(const CameraModel& camera) const {
    return normal.dot(camera.project(edge->point_m) - pixel);
  }
};

/// Mean of the images in grey.
cv::Mat_<float> mean_grey(const std::vector<cv::Mat>& images, const CameraModel& camera) {
  if (images.empty()) throw common::DataError("calibration: no image was given; needs one or more");
  cv::Mat_<float> sum;
  for (const cv::Mat& image : images) {
    if (image.cols != camera.width_px || image.rows != camera.height_px ||
        (image.type() != CV_8UC3 && image.type() != CV_8UC1))
      throw common::DataError(
          fmt::format("calibration: the image is {} x {} with {} channels, must be {} x {} in 8-bit colour "
                      "or grey; set lens.width_px and lens.height_px",
                      image.cols, image.rows, image.channels(), camera.width_px, camera.height_px));
    cv::Mat grey = image;
    if (image.channels() == 3) cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    if (sum.empty())
      grey.convertTo(sum, CV_32F, 1.0 / static_cast<double>(images.size()));
    else
      cv::scaleAdd(cv::Mat_<float>(grey), 1.0 / static_cast<double>(images.size()), sum, sum);
  }
  return sum;
}

class DishFitter {
 public:
  DishFitter(const cv::Mat_<float>& grey, const BenchGeometry& bench, const CameraModel& start,
             const CalibrationConfig& config, bool hold_intrinsics)
      : grey_(grey),
        bench_(bench),
        start_(start),
        config_(config),
        free_(hold_intrinsics ? 6 : 8),
        camera_(start),
        edges_(edges_of(bench, kPointsPerCircle, kPointsPerLine)) {}

  DishFit run() {
    camera_ = search_dish(grey_, bench_, start_);
    find_signs();
    for (const double reach_px : kReach_px) {
      find_edges(reach_within_px(bench_.wall_thickness_m / camera_.pixel_size_m(), reach_px));
      check_edges();
      for (int i = 0; i < kSteps; ++i) {
        weigh();
        step();
      }
    }
    weigh();
    return result();
  }

 private:
  /// Contrast of each part of each edge near its place, strongest first guess.
  void find_signs() {
    for (auto& kind : signs_) kind.fill(0.0);
    const Visibility visible(camera_, bench_);
    for (const EdgePoint& edge : edges_) {
      const SeenEdge seen = see(camera_, edge);
      if (!visible(edge, seen.pixel, 12.0)) continue;
      for (const double sign : {-1.0, 1.0}) {
        const EdgeHit hit = find_edge(grey_, seen, 4.0, sign, kLeastContrast);
        if (hit.found) signs_[edge.kind][static_cast<std::size_t>(edge.part)] += hit.contrast;
      }
    }
  }

  void find_edges(double reach_px) {
    const Visibility visible(camera_, bench_);
    found_.clear();
    expected_.fill(0);
    for (const EdgePoint& edge : edges_) {
      const SeenEdge seen = see(camera_, edge);
      if (!visible(edge, seen.pixel, 5.0)) continue;
      ++expected_[edge.kind];
      const double sign = signs_[edge.kind][static_cast<std::size_t>(edge.part)] < 0.0 ? -1.0 : 1.0;
      const EdgeHit hit = find_edge(grey_, seen, reach_px, sign, kLeastContrast);
      if (hit.found) found_.push_back({&edge, seen.pixel + hit.offset_px * seen.normal, seen.normal, 1.0});
    }
  }

  void check_edges() const {
    std::int64_t rim_expected = 0;
    std::int64_t rim = 0;
    std::int64_t lines = 0;
    for (const EdgeKind kind : {kRimInside, kRimOutside}) rim_expected += expected_[kind];
    for (const Found& found : found_)
      ++(found.edge->kind == kRimInside || found.edge->kind == kRimOutside ? rim : lines);
    lines = std::count_if(found_.begin(), found_.end(),
                          [](const Found& found) { return !is_circle(found.edge->kind); });
    if (rim_expected < kPointsPerCircle / 2 ||
        static_cast<double>(rim) < config_.min_found * static_cast<double>(rim_expected))
      throw common::DataError(
          fmt::format("calibration: the dish was not found: {} of {} points of its rim, needs a fraction of "
                      "{:.2f}; look at the image, and check lens.focal_px, lens.distance_m and bench",
                      rim, rim_expected, config_.min_found));
    if (lines < kLeastLinePoints)
      throw common::DataError(
          "calibration: " + std::to_string(lines) + " points of the coils' base lines are in view, needs " +
          std::to_string(kLeastLinePoints) + "; at least one coil face must be in the image");
  }

  /// Tukey's weights, scaled by the median residual.
  void weigh() {
    std::vector<double> sizes;
    for (const Found& found : found_) sizes.push_back(std::abs(found.residual(camera_)));
    const double scale = std::max(1.4826 * common::median(sizes), kLeastScale_px);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const double ratio = sizes[i] / (kTukey * scale);
      found_[i].weight = ratio < 1.0 ? (1.0 - ratio * ratio) * (1.0 - ratio * ratio) : 0.0;
    }
  }

  void step() {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(free_, free_);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(free_);
    std::array<CameraModel, 8> ahead;
    std::array<CameraModel, 8> behind;
    for (int i = 0; i < free_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      ahead[at] = stepped(camera_, kProbe[at] * Step::Unit(i));
      behind[at] = stepped(camera_, -kProbe[at] * Step::Unit(i));
    }
    Eigen::VectorXd slope(free_);
    for (const Found& found : found_) {
      if (found.weight <= 0.0) continue;
      for (int i = 0; i < free_; ++i) {
        const auto at = static_cast<std::size_t>(i);
        slope(i) = (found.residual(ahead[at]) - found.residual(behind[at])) / (2.0 * kProbe[at]);
      }
      const double worth = found.weight / (kPointSigma_px * kPointSigma_px);
      normal += worth * slope * slope.transpose();
      right -= worth * found.residual(camera_) * slope;
    }
    if (free_ == 8) {
      pull(6, std::log(camera_.focal_px / start_.focal_px), config_.focal_sigma, normal, right);
      pull(7, camera_.k1 - start_.k1, config_.k1_sigma, normal, right);
    }
    Step change = Step::Zero();
    change.head(free_) = normal.ldlt().solve(right);
    if (!change.allFinite()) throw common::DataError("calibration: the edges found do not fix the camera");
    camera_ = stepped(camera_, change);
  }

  static void pull(int at, double away, double sigma, Eigen::MatrixXd& normal, Eigen::VectorXd& right) {
    normal(at, at) += 1.0 / (sigma * sigma);
    right(at) -= away / (sigma * sigma);
  }

  DishFit result() const {
    DishFit fit;
    fit.edges.resize(kEdgeKinds);
    double sum = 0.0;
    std::int64_t used = 0;
    for (int kind = 0; kind < kEdgeKinds; ++kind) {
      fit.edges[static_cast<std::size_t>(kind)].name = name_of(static_cast<EdgeKind>(kind));
      fit.edges[static_cast<std::size_t>(kind)].expected = expected_[static_cast<std::size_t>(kind)];
    }
    for (const Found& found : found_) {
      if (found.weight <= 0.0) continue;
      const double residual = found.residual(camera_);
      EdgeUse& use = fit.edges[found.edge->kind];
      ++use.used;
      use.rms_px += residual * residual;
      sum += residual * residual;
      ++used;
    }
    for (EdgeUse& use : fit.edges)
      use.rms_px = use.used > 0 ? std::sqrt(use.rms_px / static_cast<double>(use.used)) : 0.0;
    fit.calibration.camera = camera_;
    fit.calibration.reprojection_rms_px =
        std::sqrt(sum / static_cast<double>(std::max<std::int64_t>(used, 1)));
    fit.calibration.reprojection_rms_m = fit.calibration.reprojection_rms_px * camera_.pixel_size_m();
    fit.calibration.method = "dish";
    check_result(fit, used);
    return fit;
  }

  void check_result(const DishFit& fit, std::int64_t used) const {
    std::int64_t expected = 0;
    for (const std::int64_t count : expected_) expected += count;
    if (static_cast<double>(used) < config_.min_found * static_cast<double>(expected))
      throw common::DataError(
          fmt::format("calibration: only {} of {} expected points of dish and coils fit, needs a fraction of "
                      "{:.2f}; check the sizes under bench, and the image",
                      used, expected, config_.min_found));
    if (!(fit.calibration.reprojection_rms_px <= config_.max_rms_px))
      throw common::DataError(
          fmt::format("calibration: residual {:.2f} px, must be at most max_rms_px = {:.2f}; check the sizes "
                      "under bench, focus the lens, light the dish evenly",
                      fit.calibration.reprojection_rms_px, config_.max_rms_px));
  }

  const cv::Mat_<float>& grey_;
  const BenchGeometry& bench_;
  const CameraModel start_;
  const CalibrationConfig& config_;
  const int free_;
  CameraModel camera_;
  std::vector<EdgePoint> edges_;
  std::array<std::array<double, kParts>, kEdgeKinds> signs_{};
  std::array<std::int64_t, kEdgeKinds> expected_{};
  std::vector<Found> found_;
};

}  // namespace

DishFit fit_dish(const std::vector<cv::Mat>& images, const BenchGeometry& bench, const CameraModel& start,
                 const CalibrationConfig& config, bool hold_intrinsics) {
  const cv::Mat_<float> grey = mean_grey(images, start);
  CameraModel over_fluid = start;
  if (bench.fluid_depth_m > 0.0) over_fluid.fluid = fluid_of(bench);
  return DishFitter(grey, bench, over_fluid, config, hold_intrinsics).run();
}

Calibration calibrate_from_dish(const std::vector<cv::Mat>& images, const BenchGeometry& bench,
                                const LensConfig& nominal, const CalibrationConfig& config) {
  return fit_dish(images, bench, nominal_camera(nominal), config).calibration;
}

FloorError floor_error(const CameraModel& camera, const CameraModel& truth, const BenchGeometry& bench) {
  constexpr int kCells = 20;
  FloorError error;
  double sum = 0.0;
  int count = 0;
  for (int i = -kCells; i <= kCells; ++i) {
    for (int j = -kCells; j <= kCells; ++j) {
      const geometry::Vector2 point =
          bench.dish_radius_m / kCells * geometry::Vector2(static_cast<double>(i), static_cast<double>(j));
      if (point.norm() > bench.dish_radius_m) continue;
      const double away = (camera.to_dish(truth.project_floor(point)) - point).norm();
      sum += away * away;
      error.max_m = std::max(error.max_m, away);
      ++count;
    }
  }
  error.rms_m = std::sqrt(sum / count);
  return error;
}

double camera_moved_m(const cv::Mat& image, const Calibration& calibration, const BenchGeometry& bench,
                      const CalibrationConfig& config) {
  const DishFit now = fit_dish({image}, bench, calibration.camera, config, true);
  return floor_error(now.calibration.camera, calibration.camera, bench).rms_m;
}

}  // namespace lodestone::imaging
