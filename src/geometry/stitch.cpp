#include "lodestone/geometry/stitch.h"

#include <cmath>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::geometry {
namespace {

constexpr int kPieces = 40;  // of the curve from entry to exit

Vector2 ahead_of(const Pose2& pose) { return {std::cos(pose.heading_rad), std::sin(pose.heading_rad)}; }

/// Of a cubic Hermite curve, at a share of it from 0 to 1.
struct Curve {
  Vector2 from_m, to_m, leaves_m, comes_m;  ///< ends, and the tangents there

  Vector2 at(double t) const {
    const double t2 = t * t, t3 = t2 * t;
    return (2.0 * t3 - 3.0 * t2 + 1.0) * from_m + (t3 - 2.0 * t2 + t) * leaves_m +
           (3.0 * t2 - 2.0 * t3) * to_m + (t3 - t2) * comes_m;
  }
  Vector2 tangent(double t) const {
    const double t2 = t * t;
    return 6.0 * (t - t2) * (to_m - from_m) + (3.0 * t2 - 4.0 * t + 1.0) * leaves_m +
           (3.0 * t2 - 2.0 * t) * comes_m;
  }
};

/// Points of a path, and how the needle lies at each.
struct Way {
  std::vector<Vector2> points_m;
  std::vector<double> heading_rad;

  void add(const Vector2& point_m, double lies_rad) {
    points_m.push_back(point_m);
    heading_rad.push_back(lies_rad);
  }
};

void add_through(const Stitch& stitch, double approach_m, double leave_m, Way& way) {
  const Vector2 entry_m = stitch.entry.position_m(), exit_m = stitch.exit.position_m();
  const double apart_m = (exit_m - entry_m).norm();
  if (!(apart_m > 0.0))
    throw common::DataError("a stitch needs an entry and an exit at two points, not at one");
  const Curve curve{entry_m, exit_m, apart_m * ahead_of(stitch.entry), apart_m * ahead_of(stitch.exit)};
  if (approach_m > 0.0) way.add(entry_m - approach_m * ahead_of(stitch.entry), stitch.entry.heading_rad);
  way.add(entry_m, stitch.entry.heading_rad);
  for (int i = 1; i < kPieces; ++i) {
    const double t = static_cast<double>(i) / kPieces;
    const Vector2 along_m = curve.tangent(t);
    way.add(curve.at(t), std::atan2(along_m.y(), along_m.x()));
  }
  way.add(exit_m, stitch.exit.heading_rad);
  if (leave_m > 0.0) way.add(exit_m + leave_m * ahead_of(stitch.exit), stitch.exit.heading_rad);
}

}  // namespace

std::vector<Stitch> running_stitch(std::int64_t count, double length_m, double pitch_m) {
  LODESTONE_CHECK(count >= 1, "at least one stitch, not " + std::to_string(count));
  std::vector<Stitch> stitches;
  for (std::int64_t i = 0; i < count; ++i) {
    const double x_m = pitch_m * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1));
    const double up = i % 2 == 0 ? 1.0 : -1.0;
    const double heading_rad = up * 0.5 * kPi;
    stitches.push_back({{x_m, -up * 0.5 * length_m, heading_rad}, {x_m, up * 0.5 * length_m, heading_rad}});
  }
  return stitches;
}

Path way_through(const Stitch& stitch, double approach_m, double leave_m) {
  return way_through_all({stitch}, approach_m, leave_m);
}

Path way_through_all(const std::vector<Stitch>& stitches, double approach_m, double leave_m) {
  Way way;
  for (const Stitch& stitch : stitches) add_through(stitch, approach_m, leave_m, way);
  return Path(std::move(way.points_m), false).with_heading(PathHeading::column(std::move(way.heading_rad)));
}

}  // namespace lodestone::geometry
