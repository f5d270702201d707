#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/path_heading.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// Points of a CSV file with header `x_m,y_m`. Throws common::DataError naming file, line and column.
std::vector<Vector2> read_points_csv(const std::string& file);

/// A polyline in the dish frame, open or closed, parametrised by arc length, with or without a heading to lie
/// at along it.
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
  /// Through the points of a CSV file with header `x_m,y_m` or `x_m,y_m,heading_rad`; closed when the last
  /// one equals the first. With the third column it has the rule kColumn, else no heading. Throws as
  /// read_points_csv().
  static Path from_csv(const std::string& file);

  /// The same way, with this heading along it. Throws common::DataError where a column has not one heading
  /// for each of points_m().
  Path with_heading(PathHeading heading) const;

  double length_m() const { return arc_m_.back(); }
  bool closed() const { return closed_; }
  const std::vector<Vector2>& points_m() const { return points_m_; }
  const PathHeading& heading() const { return heading_; }

  /// Point at an arc length; closed paths wrap, open ones stop at their ends.
  Vector2 at(double arc_m) const;
  /// How the needle shall lie there, in rad: at a corner as on the way on; nothing without a heading.
  std::optional<double> heading_rad(double arc_m) const;
  /// Where the path goes and how the needle shall lie there, about every `step_m`, for drawings; empty
  /// without a heading.
  std::vector<Pose2> poses(double step_m) const;
  Nearest nearest(const Vector2& position_m) const;
  /// The vertices where the direction turns by at least `min_turn_rad`, in order along the path, and the ends
  /// of an open one.
  std::vector<Vector2> corners_m(double min_turn_rad = kPi / 6.0) const;

 private:
  /// From a point to the next, with a fraction of that way behind.
  struct Place {
    std::size_t point;
    double share;
  };
  Place place(double arc_m) const;

  std::vector<Vector2> points_m_;  // closed paths repeat the first point at the end
  std::vector<double> arc_m_;
  bool closed_;
  PathHeading heading_;
};

}  // namespace lodestone::geometry
