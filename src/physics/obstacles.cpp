#include "lodestone/physics/obstacles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/polygon.h"

namespace lodestone::physics {
namespace {

constexpr int kDrawnCorners = 72;  // of a disc
constexpr std::size_t kMostCorners = 1000;

/// How far along the axis, from 0 at the tail to 1 at the head, it comes nearest to a point; beyond these
/// where that is an end.
double nearest_along(const Capsule& capsule, const geometry::Vector2& point_m) {
  const geometry::Vector2 axis_m = capsule.head_m - capsule.tail_m;
  const double length2_m2 = axis_m.squaredNorm();
  return length2_m2 > 0.0 ? (point_m - capsule.tail_m).dot(axis_m) / length2_m2 : 0.0;
}

geometry::Vector2 axis_point_m(const Capsule& capsule, double along) {
  return capsule.tail_m + std::clamp(along, 0.0, 1.0) * (capsule.head_m - capsule.tail_m);
}

/// Whether a point lies nearer to this corner of a body than to the sides that meet there. Everything does to
/// a body that is a point.
bool before_corner(const std::vector<geometry::Vector2>& corners_m, std::size_t corner,
                   const geometry::Vector2& point_m) {
  const std::size_t count = corners_m.size();
  const geometry::Vector2 from_m = point_m - corners_m[corner];
  return from_m.dot(corners_m[(corner + count - 1) % count] - corners_m[corner]) <= 0.0 &&
         from_m.dot(corners_m[(corner + 1) % count] - corners_m[corner]) <= 0.0;
}

/// Whether the body's inside is less than half of what is around this corner.
bool juts_out(const std::vector<geometry::Vector2>& corners_m, std::size_t corner) {
  const std::size_t count = corners_m.size();
  if (count == 1) return true;
  const geometry::Vector2 in_m = corners_m[corner] - corners_m[(corner + count - 1) % count];
  const geometry::Vector2 out_m = corners_m[(corner + 1) % count] - corners_m[corner];
  return in_m.x() * out_m.y() - in_m.y() * out_m.x() > 0.0;
}

}  // namespace

void ObstacleConfig::validate() const {
  if (shape == ObstacleShape::kDisc) {
    if (centre_m.size() != 2) throw common::InvalidConfig("centre_m", centre_m, "hold [x, y]");
    if (!corners_m.empty()) throw common::InvalidConfig("corners_m", corners_m, "be [] where shape is disc");
    return;
  }
  if (corners_m.size() % 2 != 0 || corners_m.size() < 6 || corners_m.size() > 2 * kMostCorners)
    throw common::InvalidConfig("corners_m", corners_m, "hold [x, y, x, y, ...] of 3 to 1000 corners");
  if (!geometry::is_simple_polygon(points_m()))
    throw common::InvalidConfig(
        "corners_m", corners_m,
        "go once round the obstacle: no two corners in turn at the same place, and no "
        "side that crosses or touches another");
}

std::vector<geometry::Vector2> ObstacleConfig::points_m() const {
  if (shape == ObstacleShape::kDisc) return {geometry::Vector2(centre_m[0], centre_m[1])};
  std::vector<geometry::Vector2> corners;
  for (std::size_t i = 0; i + 1 < corners_m.size(); i += 2)
    corners.emplace_back(corners_m[i], corners_m[i + 1]);
  return corners;
}

std::vector<geometry::Vector2> ObstacleConfig::outline_m() const {
  if (shape == ObstacleShape::kPolygon) return points_m();
  const geometry::Vector2 middle_m(centre_m[0], centre_m[1]);
  std::vector<geometry::Vector2> round;
  for (int i = 0; i < kDrawnCorners; ++i) {
    const double angle_rad = 2.0 * geometry::kPi * i / kDrawnCorners;
    round.push_back(middle_m + radius_m * geometry::Vector2(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return round;
}

double ObstacleConfig::reach_m() const {
  double farthest_m = 0.0;
  for (const geometry::Vector2& point_m : points_m()) farthest_m = std::max(farthest_m, point_m.norm());
  return shape == ObstacleShape::kDisc ? farthest_m + radius_m : farthest_m;
}

Obstacles::Obstacles(const std::vector<ObstacleConfig>& configs) {
  for (const ObstacleConfig& config : configs) {
    config.validate();
    Body body;
    body.corners_m = config.points_m();
    body.rounding_m = config.shape == ObstacleShape::kDisc ? config.radius_m : 0.0;
    if (geometry::signed_area_m2(body.corners_m) < 0.0)
      std::reverse(body.corners_m.begin(), body.corners_m.end());
    body.middle_m = geometry::Vector2::Zero();
    for (const geometry::Vector2& corner_m : body.corners_m)
      body.middle_m += corner_m / static_cast<double>(body.corners_m.size());
    body.reach_m = 0.0;
    for (const geometry::Vector2& corner_m : body.corners_m)
      body.reach_m = std::max(body.reach_m, (corner_m - body.middle_m).norm());
    body.reach_m += body.rounding_m;
    bodies_.push_back(std::move(body));
  }
}

void Obstacles::find_at_corner(const Body& body, std::size_t corner, const Capsule& capsule, double within_m,
                               std::vector<Touch>& touches) {
  if (!juts_out(body.corners_m, corner)) return;
  const double along = nearest_along(capsule, body.corners_m[corner]);
  const geometry::Vector2 at_m = axis_point_m(capsule, along);
  // An end that lies before a side is found there. The middle of the axis cannot be.
  if ((along <= 0.0 || along >= 1.0) && !before_corner(body.corners_m, corner, at_m)) return;
  const geometry::Vector2 to_m = body.corners_m[corner] - at_m;
  const double distance_m = to_m.norm();
  const double clearance_m = distance_m - body.rounding_m - capsule.radius_m;
  if (clearance_m <= within_m && distance_m > 0.0) touches.push_back({at_m, to_m / distance_m, clearance_m});
}

void Obstacles::find_at_side(const Body& body, std::size_t side, const Capsule& capsule, double within_m,
                             std::vector<Touch>& touches) {
  const geometry::Vector2& from_m = body.corners_m[side];
  const geometry::Vector2 side_m = body.corners_m[(side + 1) % body.corners_m.size()] - from_m;
  const double length_m = side_m.norm();
  const geometry::Vector2 outwards(side_m.y() / length_m, -side_m.x() / length_m);
  for (const geometry::Vector2& end_m : {capsule.tail_m, capsule.head_m}) {
    const double along_m = (end_m - from_m).dot(side_m) / length_m;
    const double distance_m = (end_m - from_m).dot(outwards);
    const double clearance_m = distance_m - capsule.radius_m;
    if (along_m >= 0.0 && along_m <= length_m && distance_m > 0.0 && clearance_m <= within_m)
      touches.push_back({end_m, -outwards, clearance_m});
  }
}

void Obstacles::find(const Capsule& capsule, double within_m, std::vector<Touch>& touches) const {
  const geometry::Vector2 middle_m = 0.5 * (capsule.tail_m + capsule.head_m);
  const double reach_m = 0.5 * (capsule.head_m - capsule.tail_m).norm() + capsule.radius_m + within_m;
  for (const Body& body : bodies_) {
    if ((body.middle_m - middle_m).norm() > body.reach_m + reach_m) continue;
    for (std::size_t corner = 0; corner < body.corners_m.size(); ++corner) {
      find_at_corner(body, corner, capsule, within_m, touches);
      if (body.corners_m.size() > 1) find_at_side(body, corner, capsule, within_m, touches);
    }
  }
}

bool Obstacles::on_axis(const Capsule& capsule) const {
  const auto passes_through = [&](const Body& body) {
    const std::size_t count = body.corners_m.size();
    if (count == 1) {
      const geometry::Vector2& middle_m = body.corners_m.front();
      return (axis_point_m(capsule, nearest_along(capsule, middle_m)) - middle_m).norm() < body.rounding_m;
    }
    for (std::size_t i = 0; i < count; ++i)
      if (geometry::segments_cross(capsule.tail_m, capsule.head_m, body.corners_m[i],
                                   body.corners_m[(i + 1) % count]))
        return true;
    return geometry::inside_polygon(body.corners_m, capsule.tail_m);
  };
  return std::any_of(bodies_.begin(), bodies_.end(), passes_through);
}

bool Obstacles::clear_of(const Capsule& capsule) const {
  if (on_axis(capsule)) return false;
  std::vector<Touch> touches;
  find(capsule, 0.0, touches);
  return std::all_of(touches.begin(), touches.end(),
                     [](const Touch& touch) { return touch.clearance_m >= 0.0; });
}

}  // namespace lodestone::physics
