#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/geometry/path.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::geometry {

/// One stitch: how the needle lies where it goes in, and where it comes out.
struct Stitch {
  Pose2 entry;
  Pose2 exit;
};

/// Stitches that cross a wound along x through the dish centre back and forth: the first one goes up, at the
/// heading +90 degrees, from (x, -length/2) to (x, +length/2), the next one down, and so on, `pitch_m`
/// further along x each, with the middle of them all at the centre. Throws common::LogicFault without any.
std::vector<Stitch> running_stitch(std::int64_t count, double length_m, double pitch_m);

/// The way of a needle through a stitch, with its heading: straight along the heading of the entry, from
/// `approach_m` before it; to the exit along the cubic Hermite curve that leaves and comes at the two
/// headings, as long in its tangents as the two points are apart, so straight where they lie in line; and
/// `leave_m` further straight along the heading of the exit. The needle lies along the way. Throws
/// common::DataError where entry and exit are the same point.
Path way_through(const Stitch& stitch, double approach_m, double leave_m);

/// The same through one stitch after another, and straight from behind each to before the next one, on which
/// way the needle turns. Throws common::DataError without any stitch, too.
Path way_through_all(const std::vector<Stitch>& stitches, double approach_m, double leave_m);

}  // namespace lodestone::geometry
