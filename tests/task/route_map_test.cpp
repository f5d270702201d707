#include "lodestone/task/route_map.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

using namespace lodestone;
using geometry::Vector2;
using task::RouteMap;

namespace {

const Vector2 kWest(-0.025, 0.0);
const Vector2 kEast(0.025, 0.0);

task::Region dish() { return task::Region::disc(0.035, 0.004); }

/// A disc of 4 mm in the middle, a needle of 10 mm by 1 mm, and a margin of 1 mm.
geometry::KeepOut in_the_middle() { return {{{"disc", {0.0, 0.0}, 0.004}}, 0.01, 0.001, 0.001}; }

double length_m(const std::vector<Vector2>& way) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) sum_m += (way[i] - way[i - 1]).norm();
  return sum_m;
}

double least_clearance_m(const std::vector<Vector2>& way, const geometry::KeepOut& keep_out) {
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < way.size(); ++i)
    least_m = std::min(least_m, keep_out.clearance_m(way[i - 1], way[i]));
  return least_m;
}

}  // namespace

TEST_CASE("a way goes from end to end, and around what is in it") {
  const RouteMap map(dish(), {}, {});
  const auto unhindered = map.route(kWest, kEast, {});
  REQUIRE(unhindered.size() > 3);
  CHECK(unhindered.front() == kWest);
  CHECK(unhindered.back() == kEast);
  CHECK(length_m(unhindered) < 1.2 * 0.05);
  const auto around = map.route(kWest, kEast, in_the_middle());
  REQUIRE(around.size() > 3);
  CHECK(around.back() == kEast);
  CHECK(least_clearance_m(around, in_the_middle()) > 0.001);
  CHECK(length_m(around) > length_m(unhindered));
}

TEST_CASE("clearance is a cost: the dearer it is, the wider the berth") {
  task::RouteConfig config;
  config.clearance_cost = 0.0;
  const geometry::KeepOut keep_out = in_the_middle();
  const auto narrow = RouteMap(dish(), {}, config).route(kWest, kEast, keep_out);
  config.clearance_cost = 4.0;
  const auto wide = RouteMap(dish(), {}, config).route(kWest, kEast, keep_out);
  CHECK(least_clearance_m(narrow, keep_out) > keep_out.margin_m);
  CHECK(least_clearance_m(wide, keep_out) > least_clearance_m(narrow, keep_out) + 0.002);
  CHECK(length_m(wide) > length_m(narrow));
}

TEST_CASE("where there is no way there is none") {
  const RouteMap map(dish(), {}, {});
  geometry::KeepOut keep_out = in_the_middle();
  CHECK(map.route(kWest, {0.1, 0.0}, keep_out).empty());          // far outside
  CHECK(map.route(kWest, {0.001, 0.0}, keep_out).empty());        // in the zone
  CHECK_FALSE(map.route({0.001, 0.0}, kEast, keep_out).empty());  // out of it, yes
  keep_out.zones.push_back({"wall", {0.0, -0.05, 0.0, 0.05}, 0.001});
  CHECK(map.route(kWest, kEast, keep_out).empty());
  CHECK_FALSE(map.route(kWest, {-0.01, 0.02}, keep_out).empty());
}

TEST_CASE("ways lead only where recorded pulses did, and dead cells are known") {
  const Vector2 a(0.002, 0.002), b(0.006, 0.002), c(0.010, 0.002), outside(0.1, 0.002);
  const std::vector<task::Move> moves = {{a, b}, {b, c}, {c, outside}, {a, a}};
  const RouteMap map(dish(), moves, {});
  const std::vector<Vector2> way = map.route(a, c, {});
  REQUIRE(way.size() >= 3);
  CHECK(way.front() == a);
  CHECK(way.back() == c);
  CHECK(std::any_of(way.begin(), way.end(), [&](const Vector2& at_m) { return (at_m - b).norm() < 1e-9; }));
  CHECK(length_m(way) == Approx(0.008));
  CHECK(map.route(c, a, {}).empty());
  REQUIRE(map.dead_m().size() == 1);
  CHECK((map.dead_m().front() - outside).norm() < 0.003);
  task::RouteConfig twice;
  twice.least_moves = 2;
  CHECK(RouteMap(dish(), moves, twice).route(a, c, {}).empty());
}

TEST_CASE("a way is straight where it stays in the region and clear") {
  const RouteMap map(dish(), {}, {});
  const geometry::KeepOut keep_out = in_the_middle();
  CHECK(map.straight(kWest, kEast, {}, 0.0));
  CHECK_FALSE(map.straight(kWest, kEast, keep_out, 0.0));
  CHECK(map.straight({-0.02, 0.01}, {0.02, 0.01}, keep_out, 0.005));  // 5.5 mm
  CHECK_FALSE(map.straight({-0.02, 0.01}, {0.02, 0.01}, keep_out, 0.006));
  CHECK_FALSE(map.straight(kWest, {-0.025, 0.08}, {}, 0.0));
  CHECK(map.wanted_m(keep_out) == Approx(0.009));
}
