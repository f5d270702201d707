#include "lodestone/experiments/routing.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "sphere_rig.h"

using namespace lodestone;
using experiments::route_map;
using geometry::Vector2;

namespace {

experiments::DeploymentConfig with_a_zone() {
  experiments::DeploymentConfig config;
  config.safety.keep_out = {{"vessel", {0.012, 0.0}, 0.004}};
  return config;
}

experiments::SimulatorSource released() {
  return experiments::load_simulator({}, std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best");
}

}  // namespace

TEST_CASE("ways are searched where there are zones, unless the configuration says otherwise") {
  experiments::DeploymentConfig config = with_a_zone();
  CHECK(route_map(config, nullptr, nullptr));
  CHECK_FALSE(route_map({}, nullptr, nullptr));
  experiments::DeploymentConfig may_come;
  may_come.safety.keep_out_file = "moving.json";
  CHECK(route_map(may_come, nullptr, nullptr));
  config.route.use = task::RouteUse::kNever;
  CHECK_FALSE(route_map(config, nullptr, nullptr));
  config.safety.keep_out.clear();
  config.route.use = task::RouteUse::kAlways;
  CHECK(route_map(config, nullptr, nullptr));
}

TEST_CASE("the map is the best that is known: pulses, else a policy's region, else the dish") {
  const experiments::DeploymentConfig config = with_a_zone();
  const auto dish = route_map(config, nullptr, nullptr);
  CHECK(dish->region().contains({0.038, 0.0}));
  CHECK_FALSE(dish->region().contains({0.043, 0.0}));  // the middle of a needle that lies along the wall
  CHECK(dish->dead_m().empty());
  inference::Policy policy;
  policy.region = task::Region::disc(0.02, 0.004);
  CHECK_FALSE(route_map(config, nullptr, &policy)->region().contains({0.03, 0.0}));
  const experiments::SimulatorSource simulator = released();
  const auto recorded = route_map(config, &simulator, &policy);
  CHECK(recorded->region().area_m2() > 1.5 * policy.region->area_m2());
  CHECK(recorded->region().area_m2() < geometry::kPi * 0.0425 * 0.0425);
  CHECK_FALSE(recorded->route({-0.02, 0.0}, {0.02, 0.02}, {}).empty());
}

TEST_CASE("pulses in the simulator stay in the dish, repeat, and show where it can be reached as well") {
  experiments::DeploymentConfig config = with_a_zone();
  config.route.moves = task::MovesFrom::kSimulated;
  config.route.simulated_pulses = 10;
  CHECK_THROWS_WITH(route_map(config, nullptr, nullptr), Catch::Contains("dynamics=DIR"));
  const experiments::SimulatorSource simulator = released();
  const auto moves = experiments::simulated_moves(config, simulator);
  const auto again = experiments::simulated_moves(config, simulator);
  REQUIRE(moves.size() > 1000);
  REQUIRE(again.size() == moves.size());
  double mean_m = 0.0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    REQUIRE(moves[i].to_m == again[i].to_m);
    REQUIRE(moves[i].to_m.norm() <= config.rig.dish.radius_m);
    mean_m += (moves[i].to_m - moves[i].from_m).norm() / static_cast<double>(moves.size());
  }
  CHECK(mean_m > 0.0005);
  CHECK(mean_m < 0.02);
  CHECK(route_map(config, &simulator, nullptr)->region().contains({0.0, 0.0}));
}

TEST_CASE("a place or a way in a zone is refused, and the zone is named") {
  const experiments::DeploymentConfig config = with_a_zone();
  const geometry::KeepOut keep_out = config.safety.keeps_out(config.rig);
  const Vector2 here(0.0, 0.0), beyond(0.03, 0.0);
  experiments::check_keeps_out(keep_out, here, here, "target_mm");
  CHECK_THROWS_WITH(experiments::check_keeps_out(keep_out, here, beyond, "way.csv"),
                    Catch::Contains("way.csv") && Catch::Contains("keep-out zone vessel"));
}

TEST_CASE("a sphere keeps its radius from zones, whatever stands for its heading") {
  experiments::DeploymentConfig config = with_a_zone();
  config.rig.needle = tests::sphere();
  const geometry::KeepOut keep_out = config.safety.keeps_out(config.rig);
  for (const double heading_rad : {0.0, 0.5 * geometry::kPi})
    CHECK(keep_out.clearance_m({0.0, 0.0, heading_rad}) == Approx(0.0065));  // 12 mm less 4 mm and 1.5 mm
  CHECK(keep_out.any_way_m() == keep_out.margin_m);
}

TEST_CASE("a map is written with its cells") {
  const Vector2 a(0.002, 0.002), b(0.006, 0.002), outside(0.05, 0.002);
  const task::RouteMap map(task::Region::disc(0.01, 0.004), {{a, b}, {a, outside}}, {});
  const runs::ReachMap reach = experiments::reach_map_of(map);
  CHECK(reach.cell_mm == Approx(4.0));
  CHECK(reach.reachable_mm.size() == map.region().centres_m().size());
  REQUIRE(reach.dead_mm.size() == 1);
  CHECK(reach.dead_mm.front()[0] == Approx(50.0).margin(2.1));
}
