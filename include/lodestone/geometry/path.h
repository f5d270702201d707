#pragma once

#include <string>
#include <vector>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// Points of a CSV file with header `x_m,y_m`. Throws common::DataError naming file, line and column.
std::vector<Vector2> read_points_csv(const std::string& file);

/// A polyline in the dish frame, open or closed, parametrised by arc length.
class Path {
 public:
  struct Nearest {
    Vector2 point_m;
    double arc_m;       ///< arc length of the point from the start of the path
    double distance_m;  ///< cross-track error
  };

  /// At least two points, not all equal; throws common::DataError otherwise.
  Path(std::vector<Vector2> points_m, bool closed);

  /// Square centred at the origin, sides along the axes, counter-clockwise from (+side/2, -side/2).
  static Path square(double side_m);
  /// Circle centred at the origin as a polygon of `segments`, counter-clockwise from +x.
  static Path circle(double radius_m, int segments = 180);
  /// Through the points of a CSV file; closed when the last one equals the first.
  static Path from_csv(const std::string& file);

  double length_m() const { return arc_m_.back(); }
  bool closed() const { return closed_; }
  const std::vector<Vector2>& points_m() const { return points_m_; }

  /// Point at an arc length; closed paths wrap, open ones stop at their ends.
  Vector2 at(double arc_m) const;
  Nearest nearest(const Vector2& position_m) const;
  /// The vertices where the direction turns by at least `min_turn_rad`, in order along the path, and the ends
  /// of an open one.
  std::vector<Vector2> corners_m(double min_turn_rad = kPi / 6.0) const;

 private:
  std::vector<Vector2> points_m_;  // closed paths repeat the first point at the end
  std::vector<double> arc_m_;
  bool closed_;
};

}  // namespace lodestone::geometry
