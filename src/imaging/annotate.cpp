#include "lodestone/imaging/annotate.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "drawing.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::imaging {
namespace {

using geometry::Vector2;

// Okabe and Ito's palette, as BGR.
const cv::Scalar kBlue(178, 114, 0);
const cv::Scalar kOrange(0, 159, 230);
const cv::Scalar kVermilion(0, 94, 213);
const cv::Scalar kPurple(167, 121, 204);
const cv::Scalar kYellow(66, 228, 240);
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kBlack(0, 0, 0);

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;

// Along a heading that is wanted: of a path, and of the target.
constexpr double kTick_m = 0.003, kPointer_m = 0.008;

/// One frame being drawn into.
class Pen {
 public:
  Pen(cv::Mat& image, const CameraModel& camera)
      : image_(image), camera_(camera), unit_(std::max(0.5, image.rows / 1024.0)) {}

  cv::Point2d pixel(const Vector2& point_m) const {
    const Eigen::Vector2d at = camera_.project_floor(point_m);
    return {at.x(), at.y()};
  }
  double unit() const { return unit_; }
  int width() const { return image_.cols; }
  int height() const { return image_.rows; }
  int px(double units) const { return std::max(1, static_cast<int>(std::lround(units * unit_))); }

  /// A line with a halo that sets it off from any ground. Points closer than half a pixel are left out.
  void stroke(const std::vector<cv::Point2d>& points, const cv::Scalar& colour, double units,
              const cv::Scalar& halo, bool closed = false) {
    std::vector<cv::Point> fixed;
    cv::Point2d last(-1e9, -1e9);
    for (const cv::Point2d& point : points) {
      if (!(std::abs(point.x) < 1e5 && std::abs(point.y) < 1e5) || cv::norm(point - last) < 0.5) continue;
      fixed.push_back(fixed_point(point));
      last = point;
    }
    if (fixed.size() < 2) return;
    cv::polylines(image_, fixed, closed, halo, px(units + 2.0), cv::LINE_AA, kShift);
    cv::polylines(image_, fixed, closed, colour, px(units), cv::LINE_AA, kShift);
  }

  void path(const std::vector<Vector2>& points_m, const cv::Scalar& colour, double units, bool closed = false,
            const cv::Scalar& halo = kWhite) {
    std::vector<cv::Point2d> points;
    points.reserve(points_m.size());
    for (const Vector2& point_m : points_m) {
      if (point_m.allFinite()) points.push_back(pixel(point_m));
    }
    stroke(points, colour, units, halo, closed);
  }

  void disc(const cv::Point2d& centre, double units, const cv::Scalar& colour, const cv::Scalar& halo) {
    if (!(std::abs(centre.x) < 1e5 && std::abs(centre.y) < 1e5)) return;
    const auto radius = [this](double size) {
      return static_cast<int>(std::lround(size * unit_ * (1 << kShift)));
    };
    cv::circle(image_, fixed_point(centre), radius(units + 1.5), halo, cv::FILLED, cv::LINE_AA, kShift);
    cv::circle(image_, fixed_point(centre), radius(units), colour, cv::FILLED, cv::LINE_AA, kShift);
  }

  void fill(const std::vector<cv::Point2d>& corners, const cv::Scalar& colour) {
    std::vector<cv::Point> fixed;
    for (const cv::Point2d& corner : corners) fixed.push_back(fixed_point(corner));
    cv::fillConvexPoly(image_, fixed, colour, cv::LINE_AA, kShift);
  }

  cv::Size text_size(const std::string& text, double size) const {
    int below = 0;
    const cv::Size box = cv::getTextSize(text, kFont, size * unit_, px(1.0), &below);
    return {box.width, box.height + below};
  }

  /// Text centred at a point, moved so that all of it is in the image, on a darkened ground.
  void label(const std::string& text, cv::Point2d centre, double size, const cv::Scalar& colour) {
    const cv::Size box = text_size(text, size);
    const double margin = 6.0 * unit_;
    const auto clamp = [](double at, double half, double limit) {
      return limit < 2.0 * half ? half : std::clamp(at, half, limit - half);
    };
    centre.x = clamp(centre.x, 0.5 * box.width + margin, width());
    centre.y = clamp(centre.y, 0.5 * box.height + margin, height());
    const cv::Rect ground(
        cv::Point2d(centre.x - 0.5 * box.width - margin, centre.y - 0.5 * box.height - margin),
        cv::Point2d(centre.x + 0.5 * box.width + margin, centre.y + 0.5 * box.height + margin));
    darken(ground);
    int below = 0;
    cv::getTextSize(text, kFont, size * unit_, px(1.0), &below);
    const cv::Point origin(static_cast<int>(centre.x - 0.5 * box.width),
                           static_cast<int>(centre.y + 0.5 * box.height - below));
    cv::putText(image_, text, origin, kFont, size * unit_, colour, px(1.0), cv::LINE_AA);
  }

  void darken(const cv::Rect& area) {
    cv::Mat part = image_(area & cv::Rect(0, 0, image_.cols, image_.rows));
    part.convertTo(part, -1, 0.3);
  }

 private:
  static cv::Point fixed_point(const cv::Point2d& point) {
    return {static_cast<int>(std::lround(point.x * (1 << kShift))),
            static_cast<int>(std::lround(point.y * (1 << kShift)))};
  }

  cv::Mat& image_;
  const CameraModel& camera_;
  double unit_;
};

void draw_target(Pen& pen, const Vector2& target_m) {
  const cv::Point2d at = pen.pixel(target_m);
  const double arm = 14.0 * pen.unit();
  for (const cv::Point2d& way : {cv::Point2d(arm, arm), cv::Point2d(arm, -arm)})
    pen.stroke({at - way, at + way}, kPurple, 4.0, kBlack);
}

/// From a point along a heading.
void draw_heading(Pen& pen, const Vector2& at_m, double heading_rad, double length_m,
                  const cv::Scalar& colour, const cv::Scalar& halo) {
  const Vector2 end_m = at_m + length_m * Vector2(std::cos(heading_rad), std::sin(heading_rad));
  pen.path({at_m, end_m}, colour, 2.0, false, halo);
}

void draw_ring(Pen& pen, const Vector2& centre_m, double radius_m, const cv::Scalar& colour) {
  constexpr int kCorners = 180;
  std::vector<Vector2> ring;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * geometry::kPi * i / kCorners;
    ring.push_back(centre_m + radius_m * Vector2(std::cos(angle), std::sin(angle)));
  }
  pen.path(ring, colour, 1.5, true, kBlack);
}

void draw_dashes(Pen& pen, const Vector2& from_m, const Vector2& to_m) {
  constexpr double kDash_m = 1e-3;
  const double length_m = (to_m - from_m).norm();
  if (!(length_m < 1.0)) return;
  const Vector2 step_m = length_m > 0.0 ? Vector2((to_m - from_m) * (kDash_m / length_m)) : Vector2::Zero();
  for (double at_m = kDash_m; at_m + kDash_m < length_m; at_m += 2.0 * kDash_m) {
    const Vector2 start_m = from_m + (at_m / kDash_m) * step_m;
    pen.path({start_m, start_m + step_m}, kOrange, 2.0);
  }
}

void draw_travelled(Pen& pen, const std::vector<std::vector<Vector2>>& stretches_m) {
  const std::vector<Vector2>* before = nullptr;
  for (const std::vector<Vector2>& stretch_m : stretches_m) {
    if (stretch_m.empty()) continue;
    if (before != nullptr) draw_dashes(pen, before->back(), stretch_m.front());
    pen.path(stretch_m, kOrange, 2.0);
    before = &stretch_m;
  }
}

void draw_pose(Pen& pen, const geometry::Pose2& pose, double length_m) {
  const Vector2 half = 0.5 * length_m * Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const Vector2 middle(pose.x_m, pose.y_m);
  const cv::Point2d head = pen.pixel(middle + half);
  pen.stroke({pen.pixel(middle - half), head}, kVermilion, 2.5, kWhite);
  pen.disc(head, 6.0, kYellow, kBlack);
  pen.disc(pen.pixel(middle), 3.0, kVermilion, kWhite);
}

/// A sphere has no head to show.
void draw_sphere(Pen& pen, const geometry::Pose2& pose, double diameter_m) {
  draw_ring(pen, pose.position_m(), 0.5 * diameter_m, kVermilion);
  pen.disc(pen.pixel(pose.position_m()), 3.0, kVermilion, kWhite);
}

/// A block arrow from `tail` along `way` (both in pixels): a shaft and a point of the same width throughout.
void draw_arrow(Pen& pen, const cv::Point2d& tail, const cv::Point2d& way, const cv::Scalar& colour) {
  const double length = cv::norm(way);
  if (length < 1.0) return;
  const cv::Point2d ahead = way / length;
  const cv::Point2d aside(-ahead.y, ahead.x);
  const auto shape = [&](double grow) {
    const double half = 5.0 * pen.unit() + grow;
    const double barb = 12.0 * pen.unit() + 2.0 * grow;
    const cv::Point2d neck = tail + ahead * std::max(0.0, length - 16.0 * pen.unit());
    pen.fill({tail - ahead * grow - aside * half, neck - aside * half, neck + aside * half,
              tail - ahead * grow + aside * half},
             grow > 0.0 ? kBlack : colour);
    pen.fill({neck - ahead * grow - aside * barb, tail + way + ahead * (1.5 * grow),
              neck - ahead * grow + aside * barb},
             grow > 0.0 ? kBlack : colour);
  };
  shape(1.5 * pen.unit());
  shape(0.0);
}

/// Each coil's arrow stands between the dish and its face, its number beside it.
void draw_currents(Pen& pen, const Annotation& annotation) {
  constexpr double kNarrowest_m = 0.004, kWidest_m = 0.02;  // of the room for an arrow
  const BenchGeometry& bench = annotation.bench;
  const std::vector<Vector2>& directions = bench.coil_directions;
  const double inner_m = bench.dish_radius_m + bench.wall_thickness_m;
  const double gap_m = std::clamp(bench.coil_face_m - inner_m, kNarrowest_m, kWidest_m);
  for (std::size_t coil = 0; coil < directions.size(); ++coil) {
    const std::vector<double>& currents_A = *annotation.coil_current_A;
    const double current_A = coil < currents_A.size() ? currents_A[coil] : 0.0;
    const double fraction = std::clamp(current_A / annotation.max_current_A, -1.0, 1.0);
    const cv::Point2d inner = pen.pixel((inner_m + 0.1 * gap_m) * directions[coil]);
    const cv::Point2d outer = pen.pixel((inner_m + 0.9 * gap_m) * directions[coil]);
    const cv::Point2d span = (outer - inner) * std::abs(fraction);
    if (fraction > 0.0) draw_arrow(pen, inner, span, kVermilion);
    if (fraction < 0.0) draw_arrow(pen, outer, -span, kBlue);
    const cv::Point2d middle = 0.5 * (inner + outer);
    const cv::Point2d beside =
        std::abs(directions[coil].y()) < 0.5 ? cv::Point2d(0.0, -44.0) : cv::Point2d(84.0, 0.0);
    pen.label(fmt::format("{:+.1f} A", current_A), middle + beside * pen.unit(), 0.7, kWhite);
  }
}

void draw_caption(Pen& pen, const Annotation& annotation) {
  std::string caption = annotation.task;
  const auto add = [&caption](const std::string& part) { caption += (caption.empty() ? "" : "   ") + part; };
  if (annotation.time_s) add(fmt::format("{:.1f} s", *annotation.time_s));
  if (annotation.error_m) add(fmt::format("error {:.2f} mm", 1e3 * *annotation.error_m));
  const auto line = [&pen](const std::string& text, double row, const cv::Scalar& colour) {
    const double wide = pen.text_size(text, 0.9).width + 12.0 * pen.unit();
    const double size = 0.9 * std::min(1.0, pen.width() / wide);  // a long one shrinks to fit
    pen.label(text, {0.5 * wide, row * pen.unit()}, size, colour);
  };
  if (!caption.empty()) line(caption, 20.0, kWhite);
  if (!annotation.pose && !annotation.no_pose_reason.empty())
    line("no pose: " + annotation.no_pose_reason, 66.0, kYellow);
}

}  // namespace

void annotate(cv::Mat& image, const CameraModel& camera, const Annotation& annotation) {
  LODESTONE_CHECK(image.type() == CV_8UC3, "a frame to draw into must be 8-bit BGR");
  LODESTONE_CHECK(image.cols == camera.width_px && image.rows == camera.height_px,
                  "a frame of " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                      " must be of its camera's size " + std::to_string(camera.width_px) + "x" +
                      std::to_string(camera.height_px));
  LODESTONE_CHECK(annotation.max_current_A > 0.0, "max_current_A must be positive");
  Pen pen(image, camera);
  draw_ring(pen, Vector2::Zero(), annotation.bench.dish_radius_m, kWhite);
  pen.path(annotation.reference_m, kBlue, 2.0);
  for (const geometry::Pose2& lies : annotation.reference_headings)
    draw_heading(pen, lies.position_m(), lies.heading_rad, kTick_m, kBlue, kWhite);
  draw_travelled(pen, annotation.travelled_m);
  if (annotation.target_m && annotation.target_heading_rad)
    draw_heading(pen, *annotation.target_m, *annotation.target_heading_rad, kPointer_m, kPurple, kBlack);
  if (annotation.target_m) draw_target(pen, *annotation.target_m);
  if (annotation.pose) {
    if (annotation.bench.sphere)
      draw_sphere(pen, *annotation.pose, annotation.bench.needle_diameter_m);
    else
      draw_pose(pen, *annotation.pose, annotation.bench.needle_length_m);
    draw_ring(pen, annotation.pose->position_m(), 2.0 * annotation.position_sigma_m, kVermilion);
  } else if (annotation.last_seen_m) {
    draw_ring(pen, *annotation.last_seen_m, 0.5 * annotation.bench.needle_length_m, kYellow);
  }
  if (annotation.coil_current_A) draw_currents(pen, annotation);
  draw_caption(pen, annotation);
}

}  // namespace lodestone::imaging
