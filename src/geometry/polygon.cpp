#include "lodestone/geometry/polygon.h"

#include <algorithm>
#include <cstddef>

namespace lodestone::geometry {
namespace {

double cross_product(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area of a triangle; positive where it goes counter-clockwise.
double turn_of(const Vector2& a, const Vector2& b, const Vector2& c) {
  const Vector2 to_b = b - a, to_c = c - a;
  return cross_product(to_b, to_c);
}

/// Whether a point that is in line with the ends of a segment lies on it.
bool between(const Vector2& from, const Vector2& to, const Vector2& point) {
  return std::min(from.x(), to.x()) <= point.x() && point.x() <= std::max(from.x(), to.x()) &&
         std::min(from.y(), to.y()) <= point.y() && point.y() <= std::max(from.y(), to.y());
}

bool ends_on(const Vector2& from, const Vector2& to, const Vector2& point) {
  return turn_of(from, to, point) == 0.0 && between(from, to, point);
}

}  // namespace

double signed_area_m2(const std::vector<Vector2>& corners_m) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners_m.size(); ++i)
    twice += cross_product(corners_m[i], corners_m[(i + 1) % corners_m.size()]);
  return 0.5 * twice;
}

bool inside_polygon(const std::vector<Vector2>& corners_m, const Vector2& point_m) {
  bool inside = false;
  for (std::size_t i = 0; i < corners_m.size(); ++i) {
    const Vector2& from = corners_m[i];
    const Vector2& to = corners_m[(i + 1) % corners_m.size()];
    if ((from.y() > point_m.y()) == (to.y() > point_m.y())) continue;
    const double up = (point_m.y() - from.y()) / (to.y() - from.y());
    if (point_m.x() < from.x() + up * (to.x() - from.x())) inside = !inside;
  }
  return inside;
}

bool segments_cross(const Vector2& a_from_m, const Vector2& a_to_m, const Vector2& b_from_m,
                    const Vector2& b_to_m) {
  const bool apart_b =
      (turn_of(a_from_m, a_to_m, b_from_m) > 0.0) != (turn_of(a_from_m, a_to_m, b_to_m) > 0.0);
  const bool apart_a =
      (turn_of(b_from_m, b_to_m, a_from_m) > 0.0) != (turn_of(b_from_m, b_to_m, a_to_m) > 0.0);
  return apart_a && apart_b && !ends_on(a_from_m, a_to_m, b_from_m) && !ends_on(a_from_m, a_to_m, b_to_m) &&
         !ends_on(b_from_m, b_to_m, a_from_m) && !ends_on(b_from_m, b_to_m, a_to_m);
}

bool is_simple_polygon(const std::vector<Vector2>& corners_m) {
  const std::size_t count = corners_m.size();
  if (count < 3) return false;
  const auto corner = [&](std::size_t i) -> const Vector2& { return corners_m[i % count]; };
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2 side = corner(i + 1) - corner(i);
    const Vector2 next = corner(i + 2) - corner(i + 1);
    if (side.squaredNorm() == 0.0) return false;
    if (cross_product(side, next) == 0.0 && side.dot(next) < 0.0) return false;  // back along itself
    for (std::size_t j = i + 2; j < count; ++j) {
      if (i == 0 && j + 1 == count) continue;  // its neighbour on the other side
      if (segments_cross(corner(i), corner(i + 1), corner(j), corner(j + 1)) ||
          ends_on(corner(i), corner(i + 1), corner(j)) || ends_on(corner(i), corner(i + 1), corner(j + 1)) ||
          ends_on(corner(j), corner(j + 1), corner(i)) || ends_on(corner(j), corner(j + 1), corner(i + 1)))
        return false;
    }
  }
  return true;
}

}  // namespace lodestone::geometry
