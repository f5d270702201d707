#include "dish_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/geometry/angle.h"

namespace lodestone::imaging {
namespace {

constexpr double kStep_px = 0.5;
constexpr int kKernelReach = 5;  ///< samples; 2.5 px
/// The dark bore makes the base line of a coil sharp; the winding beside it may be as bright as the plate.
constexpr double kPartOfBore = 0.92;
/// Profiles are averaged over this way along the edge, against noise.
constexpr std::array<double, 3> kAlong_px = {-1.5, 0.0, 1.5};

EdgePoint circle_point(EdgeKind kind, double radius_m, double height_m, double angle_rad) {
  const Eigen::Vector3d outward(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  EdgePoint edge;
  edge.kind = kind;
  edge.part = static_cast<int>(angle_rad / (2.0 * geometry::kPi) * kParts);
  edge.point_m = radius_m * outward + Eigen::Vector3d(0.0, 0.0, height_m);
  edge.along = {-outward.y(), outward.x(), 0.0};
  edge.outward = outward;
  return edge;
}

Eigen::Vector3d axis_of(EdgeKind coil) {
  switch (coil) {
    case kCoilPlusX:
      return {1.0, 0.0, 0.0};
    case kCoilMinusX:
      return {-1.0, 0.0, 0.0};
    case kCoilPlusY:
      return {0.0, 1.0, 0.0};
    default:
      return {0.0, -1.0, 0.0};
  }
}

/// Derivative of a normal distribution of standard deviation 1 px, at steps of kStep_px, for a unit slope 1.
const std::array<float, 2 * kKernelReach + 1>& kernel() {
  static const auto values = [] {
    std::array<float, 2 * kKernelReach + 1> k{};
    double slope = 0.0;
    for (int i = -kKernelReach; i <= kKernelReach; ++i) {
      const double x = i * kStep_px;
      k[static_cast<std::size_t>(i + kKernelReach)] = static_cast<float>(x * std::exp(-0.5 * x * x));
      slope += x * x * std::exp(-0.5 * x * x);
    }
    for (float& value : k) value = static_cast<float>(value / slope);
    return k;
  }();
  return values;
}

}  // namespace

const char* name_of(EdgeKind kind) {
  static const char* const names[] = {"floor",   "rim inside", "rim outside", "coil +x",
                                      "coil -x", "coil +y",    "coil -y"};
  return names[kind];
}

std::vector<EdgePoint> edges_of(const BenchGeometry& bench, int per_circle, int per_line) {
  std::vector<EdgePoint> edges;
  for (int i = 0; i < per_circle; ++i) {
    const double angle = 2.0 * geometry::kPi * (i + 0.5) / per_circle;
    const double outer = bench.dish_radius_m + bench.wall_thickness_m;
    edges.push_back(circle_point(kFloor, bench.dish_radius_m, 0.0, angle));
    edges.push_back(circle_point(kRimInside, bench.dish_radius_m, bench.wall_height_m, angle));
    edges.push_back(circle_point(kRimOutside, outer, bench.wall_height_m, angle));
  }
  for (const EdgeKind coil : {kCoilPlusX, kCoilMinusX, kCoilPlusY, kCoilMinusY}) {
    const Eigen::Vector3d axis = axis_of(coil);
    const Eigen::Vector3d along(-axis.y(), axis.x(), 0.0);
    const double half = kPartOfBore * bench.coil_bore_radius_m;
    for (int i = 0; i < per_line; ++i) {
      const double way = 2.0 * (i + 0.5) / per_line - 1.0;
      edges.push_back({coil, 0, bench.coil_face_m * axis + way * half * along, along, axis});
    }
  }
  return edges;
}

SeenEdge see(const CameraModel& camera, const EdgePoint& edge) {
  constexpr double kProbe_m = 1e-4;
  SeenEdge seen;
  seen.pixel = camera.project(edge.point_m);
  const Eigen::Vector2d along = camera.project(edge.point_m + kProbe_m * edge.along) - seen.pixel;
  const Eigen::Vector2d outward = camera.project(edge.point_m + kProbe_m * edge.outward) - seen.pixel;
  seen.normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
  if (seen.normal.dot(outward) < 0.0) seen.normal = -seen.normal;
  return seen;
}

Visibility::Visibility(const CameraModel& camera, const BenchGeometry& bench)
    : bench_(bench),
      eye_(-(camera.rotation.transpose() * camera.translation_m)),
      pixel_m_(camera.pixel_size_m()),
      width_px_(static_cast<double>(camera.width_px)),
      height_px_(static_cast<double>(camera.height_px)) {}

bool Visibility::clear_of_neighbour(const EdgePoint& edge) const {
  const double radius = bench_.dish_radius_m;
  const double up = bench_.wall_height_m / eye_.z();
  if (edge.kind == kFloor) {  // the ray must pass well inside the rim
    const Eigen::Vector3d at_top = edge.point_m + up * (eye_ - edge.point_m);
    return radius - at_top.head<2>().norm() > kApart_px * pixel_m_;
  }
  if (edge.kind == kRimInside) {  // seen against the wall, or against the floor, but not where these meet
    const Eigen::Vector3d behind = eye_ + (edge.point_m - eye_) / (1.0 - up);
    return std::abs(behind.head<2>().norm() - radius) > kApart_px * pixel_m_;
  }
  return true;
}

bool Visibility::operator()(const EdgePoint& edge, const Eigen::Vector2d& pixel, double margin_px) const {
  if (!(pixel.x() > margin_px && pixel.y() > margin_px && pixel.x() < width_px_ - 1.0 - margin_px &&
        pixel.y() < height_px_ - 1.0 - margin_px))
    return false;
  if (is_circle(edge.kind)) return clear_of_neighbour(edge);
  return eye_.dot(edge.outward) < bench_.coil_face_m;  // else the coil hides the foot of its own face
}

double Visibility::room_px(const EdgePoint& edge) const {
  if (is_circle(edge.kind)) return bench_.wall_thickness_m / pixel_m_;
  const double aside_m = edge.point_m.dot(edge.along);
  const double height_m =
      std::sqrt(std::max(0.0, bench_.coil_bore_radius_m * bench_.coil_bore_radius_m - aside_m * aside_m));
  const double before_face_m = bench_.coil_face_m - eye_.dot(edge.outward);
  // The ray over the bore's upper end meets the plane of the base lines so far behind the face.
  const double strip_m = before_face_m * height_m / (eye_.z() - height_m);
  const Eigen::Vector3d at_top = edge.point_m + bench_.wall_height_m / eye_.z() * (eye_ - edge.point_m);
  const double behind_rim_m = at_top.head<2>().norm() - bench_.dish_radius_m - bench_.wall_thickness_m;
  return std::min(strip_m, behind_rim_m) / pixel_m_;
}

float sample(const cv::Mat_<float>& image, double u_px, double v_px) {
  const int u = static_cast<int>(u_px);
  const int v = static_cast<int>(v_px);
  const auto right = static_cast<float>(u_px - u);
  const auto down = static_cast<float>(v_px - v);
  const float* top = image[v] + u;
  const float* bottom = image[v + 1] + u;
  const float above = top[0] + right * (top[1] - top[0]);
  const float below = bottom[0] + right * (bottom[1] - bottom[0]);
  return above + down * (below - above);
}

double reach_within_px(double room_px, double most_px) {
  constexpr double kClear_px = 4.0, kLeast_px = 3.0;
  return std::max(kLeast_px, std::min(most_px, room_px - kClear_px));
}

EdgeHit find_edge(const cv::Mat_<float>& image, const SeenEdge& seen, double reach_px, double sign,
                  double least_contrast) {
  const int reach = static_cast<int>(std::ceil(reach_px / kStep_px));
  const int half = reach + 1 + kKernelReach;
  const Eigen::Vector2d along(-seen.normal.y(), seen.normal.x());
  static thread_local std::vector<float> profile;
  static thread_local std::vector<float> slope;
  profile.assign(static_cast<std::size_t>(2 * half + 1), 0.0F);
  for (int i = -half; i <= half; ++i) {
    for (const double way : kAlong_px) {
      const Eigen::Vector2d at = seen.pixel + i * kStep_px * seen.normal + way * along;
      if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < image.cols - 1.001 && at.y() < image.rows - 1.001))
        return {};
      profile[static_cast<std::size_t>(i + half)] += sample(image, at.x(), at.y()) / kAlong_px.size();
    }
  }
  slope.assign(static_cast<std::size_t>(2 * reach + 3), 0.0F);
  for (std::size_t i = 0; i < slope.size(); ++i)
    for (std::size_t j = 0; j < kernel().size(); ++j)
      slope[i] += static_cast<float>(sign) * kernel()[j] * profile[i + j];
  EdgeHit hit;
  double best = 0.0;
  for (int i = 1; i < static_cast<int>(slope.size()) - 1; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (slope[at] < slope[at - 1] || slope[at] <= slope[at + 1] || slope[at] < least_contrast) continue;
    const double offset = (i - 1 - reach) * kStep_px;
    const double worth = slope[at] * (1.0 - 0.5 * offset * offset / (reach_px * reach_px));
    if (worth <= best) continue;
    best = worth;
    const double bend = slope[at - 1] - 2.0 * slope[at] + slope[at + 1];
    hit = {true, offset + 0.5 * kStep_px * (slope[at - 1] - slope[at + 1]) / bend, sign * slope[at]};
  }
  return hit;
}

}  // namespace lodestone::imaging
