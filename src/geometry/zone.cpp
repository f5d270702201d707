#include "lodestone/geometry/zone.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <limits>

#include "lodestone/common/config.h"
#include "lodestone/geometry/polygon.h"

namespace lodestone::geometry {
namespace {

/// Above 0 to the left of the line from a to b.
double side_of_line(const Vector2& a_m, const Vector2& b_m, const Vector2& point_m) {
  const Vector2 along_m = b_m - a_m;
  const Vector2 to_m = point_m - a_m;
  return along_m.x() * to_m.y() - along_m.y() * to_m.x();
}

double between_segments_m(const Vector2& a_m, const Vector2& b_m, const Vector2& c_m, const Vector2& d_m) {
  const bool crossing = side_of_line(a_m, b_m, c_m) * side_of_line(a_m, b_m, d_m) < 0.0 &&
                        side_of_line(c_m, d_m, a_m) * side_of_line(c_m, d_m, b_m) < 0.0;
  if (crossing) return 0.0;
  return std::min({to_segment_m(a_m, c_m, d_m), to_segment_m(b_m, c_m, d_m), to_segment_m(c_m, a_m, b_m),
                   to_segment_m(d_m, a_m, b_m)});
}

}  // namespace

double to_segment_m(const Vector2& point_m, const Vector2& a_m, const Vector2& b_m) {
  const Vector2 along_m = b_m - a_m;
  const double square = along_m.squaredNorm();
  const double t = square > 0.0 ? std::clamp((point_m - a_m).dot(along_m) / square, 0.0, 1.0) : 0.0;
  const Vector2 nearest_m = a_m + t * along_m;
  return (point_m - nearest_m).norm();
}

void Zone::validate() const {
  if (corners_m.empty() || corners_m.size() % 2 != 0)
    throw common::InvalidConfig("corners_m", corners_m,
                                "hold x and y of at least one corner: [x, y] or [x1, y1, x2, y2, ...]");
  if (corners_m.size() == 2 && !(radius_m > 0.0))
    throw common::InvalidConfig("radius_m", radius_m, "be above 0 where a zone has one corner: it is a disc");
}

std::vector<Vector2> Zone::points_m() const {
  std::vector<Vector2> points;
  for (std::size_t i = 0; i + 1 < corners_m.size(); i += 2)
    points.emplace_back(corners_m[i], corners_m[i + 1]);
  return points;
}

double Zone::distance_m(const Vector2& from_m, const Vector2& to_m) const {
  const std::vector<Vector2> corners = points_m();
  if (inside_polygon(corners, from_m)) return -radius_m;
  double least_m = std::numeric_limits<double>::infinity();
  // In this order what is not a number stays none.
  for (std::size_t i = 0; i < corners.size(); ++i)
    least_m =
        std::min(between_segments_m(from_m, to_m, corners[i], corners[(i + 1) % corners.size()]), least_m);
  return least_m - radius_m;
}

std::string Zone::called() const {
  if (!name.empty()) return name;
  const std::vector<Vector2> corners = points_m();
  if (corners.empty()) return "without corners";
  char text[64];
  std::snprintf(text, sizeof text, "at (%.1f, %.1f) mm", kMmPerM * corners.front().x(),
                kMmPerM * corners.front().y());
  return text;
}

}  // namespace lodestone::geometry
