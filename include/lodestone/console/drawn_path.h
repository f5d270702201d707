#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/keep_out.h"
#include "lodestone/geometry/path.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/task/region.h"

namespace lodestone::console {

/// A longer path is refused: all of one is looked at, shown and kept.
constexpr double kLongestPath_m = 10.0;

/// A line as a hand has drawn it, made fit to be followed: points a millimetre apart along it, each the mean
/// of its neighbours, weighted by a Gaussian of 1.5 mm. Open ends stay where they are. Throws DataError where
/// all points are one, or the line is longer than kLongestPath_m.
geometry::Path smoothed(const std::vector<geometry::Vector2>& points_m, bool closed);

/// How the needle shall lie along a path that has headings, at places that can be told apart, 200 at most.
std::vector<geometry::Pose2> shown_headings(const geometry::Path& path);

/// Where a needle may be driven: inside the dish and the fence, clear of zones to keep out of and, where it
/// is known, where needles have been seen to come and go.
struct Reachable {
  physics::RigDescription rig;
  double fence_m = 0.0;  ///< from the dish centre
  std::optional<task::Region> region;
  geometry::KeepOut keep_out = {};

  /// Why the middle of the needle cannot or may not be there; empty: it may.
  std::string why_not(const geometry::Vector2& point_m) const;
};

/// What keeps a path from being followed, looked at every millimetre: the first reason, and where it is so.
struct PathObjection {
  std::string why_not;  ///< empty: nothing
  std::vector<geometry::Vector2> bad_m;
};
PathObjection object_to(const geometry::Path& path, const Reachable& reachable);

}  // namespace lodestone::console
