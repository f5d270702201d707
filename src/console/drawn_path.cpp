#include "lodestone/console/drawn_path.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::console {
namespace {

using geometry::Vector2;

constexpr double kStep_m = 0.001;
constexpr double kSmooth_m = 0.0015;
constexpr double kReach = 3.0;  // of the Gaussian, in its standard deviations
constexpr double kHeadingsApart_m = 0.005;
constexpr double kMostHeadings = 200.0;

/// Empty where it is short enough.
std::string too_long(const geometry::Path& path) {
  if (path.length_m() <= kLongestPath_m) return "";  // neither is what is not finite
  return fmt::format("a path of {:.1f} m is too long: at most {:.0f} m", path.length_m(), kLongestPath_m);
}

/// What lies along a path, its corners among it.
template <class Look>
void walk(const geometry::Path& path, const Look& look) {
  const std::vector<Vector2>& corners_m = path.points_m();
  look(corners_m.front());
  for (std::size_t i = 1; i < corners_m.size(); ++i) {
    const Vector2 along_m = corners_m[i] - corners_m[i - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(along_m.norm() / kStep_m)));
    for (int k = 1; k <= steps; ++k) look(corners_m[i - 1] + along_m * k / steps);
  }
}

}  // namespace

geometry::Path smoothed(const std::vector<Vector2>& points_m, bool closed) {
  const geometry::Path drawn(points_m, closed);
  if (const std::string why_not = too_long(drawn); !why_not.empty()) throw common::DataError(why_not);
  const auto count = std::max(2, static_cast<int>(std::lround(drawn.length_m() / kStep_m)));
  const double step_m = drawn.length_m() / count;
  std::vector<Vector2> points;
  for (int i = 0; i < count + (closed ? 0 : 1); ++i) {
    const double at_m = step_m * i;
    // As wide on one side as on the other, or an open end would be pulled inwards.
    const double reach_m =
        closed ? kReach * kSmooth_m : std::min({kReach * kSmooth_m, at_m, drawn.length_m() - at_m});
    const int neighbours = static_cast<int>(reach_m / step_m + 1e-9);
    Vector2 sum = Vector2::Zero();
    double weights = 0.0;
    for (int k = -neighbours; k <= neighbours; ++k) {
      const double weight = std::exp(-0.5 * std::pow(k * step_m / kSmooth_m, 2));
      sum += weight * drawn.at(at_m + k * step_m);
      weights += weight;
    }
    points.push_back(sum / weights);
  }
  return {points, closed};
}

std::vector<geometry::Pose2> shown_headings(const geometry::Path& path) {
  return path.poses(std::max(kHeadingsApart_m, path.length_m() / kMostHeadings));
}

std::string Reachable::why_not(const Vector2& point_m) const {
  const auto at = [&] { return fmt::format("({:.1f}, {:.1f}) mm", 1e3 * point_m.x(), 1e3 * point_m.y()); };
  // Furthest out, the needle lies along the wall.
  if (!rig.fits({point_m.x(), point_m.y(), std::atan2(point_m.y(), point_m.x()) + 0.5 * geometry::kPi}))
    return at() + " lies outside the dish, or too near its wall for the needle";
  if (point_m.norm() > fence_m)
    return at() + fmt::format(" lies outside the fence of {:.1f} mm", 1e3 * fence_m);
  for (const geometry::Zone& zone : keep_out.zones)
    if (!(zone.distance_m(point_m, point_m) - 0.5 * keep_out.needle_diameter_m > keep_out.margin_m))
      return at() + fmt::format(" lies in the keep-out zone {}, or within its margin of {:.1f} mm",
                                zone.called(), 1e3 * keep_out.margin_m);
  if (region && !region->contains(point_m)) return at() + " lies where no needle was seen to come and go";
  return "";
}

PathObjection object_to(const geometry::Path& path, const Reachable& reachable) {
  PathObjection objection{too_long(path), {}};
  if (!objection.why_not.empty()) return objection;
  walk(path, [&](const Vector2& point_m) {
    const std::string why_not = reachable.why_not(point_m);
    if (why_not.empty()) return;
    if (objection.why_not.empty()) objection.why_not = why_not;
    objection.bad_m.push_back(point_m);
  });
  return objection;
}

}  // namespace lodestone::console
