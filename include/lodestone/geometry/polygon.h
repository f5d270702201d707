#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// Area within an outline that is given corner by corner; positive where they go counter-clockwise.
double signed_area_m2(const std::vector<Vector2>& corners_m);

/// Whether a point lies within an outline; one on the outline itself may count either way.
bool inside_polygon(const std::vector<Vector2>& corners_m, const Vector2& point_m);

/// Whether two pieces of straight lines cross, each with the ends of the other on either side. That one ends
/// on the other is no crossing.
bool segments_cross(const Vector2& a_from_m, const Vector2& a_to_m, const Vector2& b_from_m,
                    const Vector2& b_to_m);

/// Whether corners are the outline of one body: three of them at least, no two that follow one another at the
/// same place, and no side that meets another but where the next one begins.
bool is_simple_polygon(const std::vector<Vector2>& corners_m);

}  // namespace lodestone::geometry
