#pragma once

#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// Of a point from the nearest one of a segment.
double to_segment_m(const Vector2& point_m, const Vector2& a_m, const Vector2& b_m);

/// A part of the dish, in its frame: all that lies within `radius_m` of the filled polygon of its corners.
/// One corner makes a disc, two a wall, three or more a polygon, whose corners are round where it has a
/// radius.
struct Zone {
  std::string name;
  std::vector<double> corners_m;  ///< x, y of one after the other
  double radius_m = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name, "", "what it is called where it stops a run");
    v.field("corners_m", corners_m, "m",
            "x, y of its corners, one after the other, in the dish frame: one corner makes a disc, two a "
            "wall, three or more a polygon",
            {-1.0, 1.0});
    v.field("radius_m", radius_m, "m", "it reaches so far beyond its corners and sides", {0.0, 1.0});
  }
  /// Throws common::InvalidConfig for half a corner, none at all, and one that is a point.
  void validate() const;

  std::vector<Vector2> points_m() const;
  /// From the nearest point of a segment: 0 or less where that touches it. It counts how deep a segment lies
  /// in a disc or a rim of `radius_m`, not how deep in the polygon itself.
  double distance_m(const Vector2& from_m, const Vector2& to_m) const;
  /// Its name, or where it begins.
  std::string called() const;

  bool operator==(const Zone& other) const {
    return name == other.name && corners_m == other.corners_m && radius_m == other.radius_m;
  }
  bool operator!=(const Zone& other) const { return !(*this == other); }
};

}  // namespace lodestone::geometry
