#include "lodestone/data/plausibility.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::data {
namespace {

using common::DataError;
using common::shown;

constexpr double kMostOutside = 0.05;     // more are no glitches
constexpr double kSmallestReach = 0.01;   // of the dish radius
constexpr double kMostTurns_rad = 50.0;   // eight turns
constexpr std::size_t kFewestRows = 100;  // to say that all headings are small
constexpr double kSmallestTop = 0.05;     // of the largest current
constexpr std::int64_t kFewestDriven = 30;
constexpr double kClearMatch = 0.15;      // D: the paper's rig and the recorded sphere have 0.5
constexpr double kWorseThan = 1.0 / 3.0;  // of the best match

std::string named(const MappedColumn& column) {
  return "\"" + shown(column.header) + "\" (unit " + column.unit.name + ")";
}

void check_positions(const LogSizes& sizes, double dish_radius_m, const std::string& place) {
  if (static_cast<double>(sizes.outside) > kMostOutside * static_cast<double>(sizes.rows))
    throw DataError(
        fmt::format("{}: {} of {} positions lie outside the dish of {:g} mm radius, the first in line {}: "
                    "correct columns or units "
                    "of {}, centre_x and centre_y, or the rig's dish",
                    place, sizes.outside, sizes.rows, dish_radius_m * geometry::kMmPerM, sizes.outside_line,
                    sizes.positions));
  if (sizes.reach_m < kSmallestReach * dish_radius_m)
    throw DataError(fmt::format(
        "{}: no position is further than {:g} mm from the centre, in a dish of {:g} mm "
        "radius: correct columns or units of {}",
        place, sizes.reach_m * geometry::kMmPerM, dish_radius_m * geometry::kMmPerM, sizes.positions));
}

void check_headings(const LogSizes& sizes, const std::string& place) {
  const double most_rad = sizes.most_turned_rad;
  if (sizes.heading_unit == "rad" && most_rad > kMostTurns_rad)
    throw DataError(fmt::format("{}: headings reach {:g} rad: correct column or unit of {}", place, most_rad,
                                sizes.heading));
  if (sizes.heading_unit == "deg" && sizes.rows >= kFewestRows &&
      most_rad <= 2.0 * geometry::kPi * geometry::kRadPerDeg)
    throw DataError(fmt::format("{}: all headings lie within {:g} degrees: correct column or unit of {}",
                                place, most_rad * geometry::kDegPerRad, sizes.heading));
}

void check_currents(const LogSizes& sizes, const std::string& place) {
  if (sizes.most_drive >= kSmallestTop * sizes.largest_drive) return;
  throw DataError(fmt::format(
      "{}: no current is above {:g} {}, of {:g} that the rig can: correct columns or units of {}, "
      "current_noise_A, or "
      "rig.coils.max_current_A",
      place, sizes.most_drive, sizes.action_unit, sizes.largest_drive, sizes.currents));
}

/// A way in which the axes of the motion may be meant.
struct Way {
  bool swapped;
  double x, y;
  const char* says;
};
constexpr std::array<Way, 8> kWays = {
    {{false, 1.0, 1.0, ""},
     {false, 1.0, -1.0, "y is the other way round (set y_down, or exchange the currents of +y and -y)"},
     {false, -1.0, 1.0, "x is the other way round (exchange the currents of +x and -x)"},
     {false, -1.0, -1.0, "x and y are the other way round (exchange the currents of each pair)"},
     {true, 1.0, 1.0, "x and y, or the pairs of currents, are exchanged"},
     {true, 1.0, -1.0, "the axes are turned by a quarter (order of the currents, or of x and y)"},
     {true, -1.0, 1.0, "the axes are turned by a quarter (order of the currents, or of x and y)"},
     {true, -1.0, -1.0, "x and y are exchanged, and the other way round"}}};

}  // namespace

void LogSizes::see(const geometry::Vector2& position_m, double dish_radius_m, std::int64_t line) {
  const double radius_m = position_m.norm();
  ++rows;
  reach_m = std::max(reach_m, radius_m);
  if (radius_m > dish_radius_m && ++outside == 1) outside_line = line;
}

LogSizes sizes_of(const MappedLog& log, double dish_radius_m) {
  LogSizes sizes;
  for (const LogSample& sample : log.samples) {
    sizes.see(sample.pose.position_m(), dish_radius_m, sample.line);
    sizes.most_drive = std::max(sizes.most_drive, sample.drive.cwiseAbs().maxCoeff());
  }
  sizes.most_turned_rad = log.most_turned_rad;
  sizes.largest_drive = log.action_scale;
  sizes.action_unit = log.action_unit;
  sizes.positions = named(log.of(Quantity::kX).front()) + " and " + named(log.of(Quantity::kY).front());
  sizes.currents = named(log.of(Quantity::kCurrents).front());
  if (!log.heading) return sizes;
  sizes.heading_unit = log.of(Quantity::kHeading).front().unit.name;
  sizes.heading = named(log.of(Quantity::kHeading).front());
  return sizes;
}

void check_sizes(const LogSizes& sizes, double dish_radius_m, const std::string& place) {
  check_positions(sizes, dish_radius_m, place);
  check_headings(sizes, place);
  check_currents(sizes, place);
}

DirectionMatch match_directions(const Dataset& dataset) {
  const TransitionTable table = flatten(dataset);
  const auto s = static_cast<std::size_t>(table.state_size);
  double product[2][2] = {{0.0, 0.0}, {0.0, 0.0}};  // [drive axis][motion axis]
  double drives = 0.0, motions = 0.0;
  DirectionMatch match;
  match.driven = table.size();
  for (std::size_t i = 0; i < static_cast<std::size_t>(table.size()); ++i)
    for (std::size_t a = 0; a < 2; ++a) {
      const double drive = table.action[2 * i + a];
      drives += drive * drive;
      const double motion = table.next_state[s * i + a] - table.state[s * i + a];
      motions += motion * motion;
      for (std::size_t b = 0; b < 2; ++b)
        product[a][b] += drive * (table.next_state[s * i + b] - table.state[s * i + b]);
    }
  const double norm = std::sqrt(drives * motions);
  if (norm == 0.0) return match;
  for (const Way& way : kWays) {
    const double score =
        (way.x * product[0][way.swapped ? 1 : 0] + way.y * product[1][way.swapped ? 0 : 1]) / norm;
    if (way.says[0] == '\0') match.as_is = match.best = score;
    if (score <= match.best) continue;
    match.best = score;
    match.best_way = way.says;
  }
  return match;
}

void check_directions(const Dataset& dataset, const std::string& place) {
  const DirectionMatch match = match_directions(dataset);
  const double clear =
      kClearMatch + 1.0 / std::sqrt(static_cast<double>(std::max<std::int64_t>(1, match.driven)));
  if (match.driven < kFewestDriven || match.best < clear || match.as_is > kWorseThan * match.best) return;
  throw DataError(
      fmt::format("{}: the robot does not move towards the coils that are on (match {:.2f}, where {:.2f} is "
                  "possible): it seems "
                  "that {}; plausible=false takes it as it is",
                  place, match.as_is, match.best, match.best_way));
}

}  // namespace lodestone::data
