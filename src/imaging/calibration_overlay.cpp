#include "lodestone/imaging/calibration_overlay.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "drawing.h"
#include "lodestone/common/error.h"

namespace lodestone::imaging {

namespace {

constexpr double kGrid_m = 0.010;
const cv::Scalar kGridColour(200, 200, 200);
// Okabe and Ito (2008), blue, green, red.
const cv::Scalar kFloorColour(0, 94, 213);
const cv::Scalar kRimColour(233, 180, 86);
const cv::Scalar kCoilColour(0, 159, 230);
const cv::Scalar kAxisColour(167, 121, 204);

class Overlay {
 public:
  Overlay(cv::Mat& image, const CameraModel& camera) : image_(image), camera_(camera) {}

  void circle(double radius_m, double height_m, const cv::Scalar& colour) {
    std::vector<cv::Point> points;
    for (int i = 0; i < 180; ++i) {
      const double angle = 2.0 * 3.14159265358979323846 * i / 180.0;
      points.push_back(at({radius_m * std::cos(angle), radius_m * std::sin(angle), height_m}));
    }
    cv::polylines(image_, points, true, colour, 1, cv::LINE_AA, kShift);
  }

  /// Straight on the floor, bent in the image by the lens.
  void line(const geometry::Vector2& from, const geometry::Vector2& to, const cv::Scalar& colour,
            int width = 1) {
    std::vector<cv::Point> points;
    for (int i = 0; i <= 20; ++i) {
      const geometry::Vector2 point = from + i / 20.0 * (to - from);
      points.push_back(at({point.x(), point.y(), 0.0}));
    }
    cv::polylines(image_, points, false, colour, width, cv::LINE_AA, kShift);
  }

  void text(const geometry::Vector2& place, const std::string& words, const cv::Scalar& colour) {
    const cv::Point pixel = at({place.x(), place.y(), 0.0});
    cv::putText(image_, words, {(pixel.x >> kShift) - 12, (pixel.y >> kShift) + 6}, cv::FONT_HERSHEY_SIMPLEX,
                0.7, colour, 2, cv::LINE_AA);
  }

 private:
  cv::Point at(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector2d pixel = camera_.project(point_m) * (1 << kShift);
    return {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))};
  }

  cv::Mat& image_;
  const CameraModel& camera_;
};

}  // namespace

cv::Mat calibration_overlay(const cv::Mat& image, const CameraModel& camera, const BenchGeometry& bench) {
  LODESTONE_CHECK(image.type() == CV_8UC3 && image.cols == camera.width_px && image.rows == camera.height_px,
                  "an 8-bit BGR image of the camera's size");
  cv::Mat drawn = image.clone();
  Overlay overlay(drawn, camera);
  const double radius_m = bench.dish_radius_m;
  for (double at_m = -kGrid_m * std::floor(radius_m / kGrid_m); at_m <= radius_m; at_m += kGrid_m) {
    const double half_m = std::sqrt(radius_m * radius_m - at_m * at_m);
    overlay.line({at_m, -half_m}, {at_m, half_m}, kGridColour);
    overlay.line({-half_m, at_m}, {half_m, at_m}, kGridColour);
  }
  overlay.circle(radius_m, 0.0, kFloorColour);
  overlay.circle(radius_m, bench.wall_height_m, kRimColour);
  overlay.circle(radius_m + bench.wall_thickness_m, bench.wall_height_m, kRimColour);
  const double face_m = bench.coil_face_m;
  const double reach_m = bench.coil_outer_radius_m;
  for (const double sign : {-1.0, 1.0}) {
    overlay.line({sign * face_m, -reach_m}, {sign * face_m, reach_m}, kCoilColour);
    overlay.line({-reach_m, sign * face_m}, {reach_m, sign * face_m}, kCoilColour);
  }
  overlay.line({0.0, 0.0}, {0.02, 0.0}, kAxisColour, 2);
  overlay.line({0.0, 0.0}, {0.0, 0.02}, kAxisColour, 2);
  overlay.text({0.023, 0.0}, "+x", kAxisColour);
  overlay.text({0.0, 0.023}, "+y", kAxisColour);
  return drawn;
}

}  // namespace lodestone::imaging
