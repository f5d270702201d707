#include "lodestone/task/region.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/task/task.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

/// Moves between random places with x < 10 mm, and a dead zone at x > 12 mm that is entered and never left.
std::vector<task::Move> moves() {
  common::RandomStream random(1, "moves");
  std::vector<task::Move> all;
  const auto anywhere = [&] { return Vector2(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01)); };
  for (int i = 0; i < 4000; ++i) all.push_back({anywhere(), anywhere()});
  for (int i = 0; i < 50; ++i) all.push_back({anywhere(), {0.014, 0.001}});
  for (int i = 0; i < 500; ++i) all.push_back({{0.014, 0.001}, {0.0141, 0.0011}});
  // An island: moves within it, none to or from elsewhere.
  for (int i = 0; i < 50; ++i)
    all.push_back({{0.030, i % 2 == 0 ? 0.001 : 0.005}, {0.030, i % 2 == 0 ? 0.005 : 0.001}});
  return all;
}

}  // namespace

TEST_CASE("the region is what the needle came to, and got away from, in one piece") {
  const task::Region region(moves(), {});
  CHECK(region.contains({0.0, 0.0}));
  CHECK(region.contains({-0.009, 0.009}));
  CHECK_FALSE(region.contains({0.014, 0.001}));  // a dead zone
  CHECK_FALSE(region.contains({0.030, 0.001}));  // an island
  CHECK_FALSE(region.contains({0.0, 0.03}));     // never visited
  CHECK(region.area_m2() == Approx(36 * 16e-6).epsilon(0.2));
}

TEST_CASE("goals are drawn inside the region, which survives JSON") {
  const task::Region region = task::Region::from_json(task::Region(moves(), {}).json());
  task::TaskConfig config = tests::paper_task();
  common::RandomStream random(2, "goals");
  for (int i = 0; i < 1000; ++i) {
    const Vector2 goal_m = task::draw_goal(config, random, &region).position_m;
    REQUIRE(region.contains(goal_m));
    REQUIRE(goal_m.norm() <= config.goal_radius_m());
  }
  CHECK_THROWS_AS(task::Region::from_json(common::Json::object()), common::DataError);
}

TEST_CASE("cells are found by the positions in them; a disc has those whose middle lies in it") {
  const task::Region disc = task::Region::disc(0.010, 0.004);
  CHECK(disc.area_m2() == Approx(geometry::kPi * 1e-4).epsilon(0.2));
  const std::vector<Vector2> centres_m = disc.centres_m();
  for (std::size_t cell = 0; cell < centres_m.size(); ++cell) {
    REQUIRE(centres_m[cell].norm() <= 0.010);
    REQUIRE(disc.find(centres_m[cell] + Vector2(0.0019, -0.0019)) == cell);
  }
  CHECK_FALSE(disc.find({0.0119, 0.001}));
  CHECK(disc.contains({-0.0001, 0.0001}));
  CHECK((disc.centre_m(disc.cell_of({0.0119, 0.001})) - Vector2(0.010, 0.002)).norm() < 1e-12);
  CHECK((task::Region::from_json(disc.json()).centres_m() == centres_m));
}

TEST_CASE("data without a reachable cell are refused") {
  CHECK_THROWS_AS(task::Region({{{0.0, 0.0}, {0.001, 0.0}}}, {}), common::ConfigError);
}
