#include "lodestone/task/action.h"

#include <catch2/catch.hpp>

#include "paper_rig.h"

using namespace lodestone::task;
using lodestone::geometry::Vector2;

TEST_CASE("an action of more than 1 is one of 1") {
  const ActionConfig config = lodestone::tests::paper_action();
  CHECK(drive_of({0.5, -2.0}, config) == Vector2(7.5, -15.0));
}

TEST_CASE("an action may have any number of numbers, and says how many") {
  ActionConfig config = lodestone::tests::paper_action();
  config.size = 4;
  CHECK(drive_of({0.5, -2.0, 0.0, 0.1}, config) == lodestone::geometry::Drive{7.5, -15.0, 0.0, 1.5});
  config.one_axis_at_a_time = true;
  CHECK(drive_of({0.5, -2.0, 0.0, 0.1}, config) == lodestone::geometry::Drive{0.0, -15.0, 0.0, 0.0});
  lodestone::common::Json json = action_to_json(config);
  CHECK(action_from_json(json, "test").size == 4);
  json["size"] = 17;
  CHECK_THROWS_WITH(action_from_json(json, "test"), Catch::Contains("size = 17 must be within 1 .. 16"));
  json.erase("size");  // from before there were other drives
  CHECK(action_from_json(json, "test").size == 2);
}

TEST_CASE("a weak action falls into the dead band") {
  ActionConfig config = lodestone::tests::paper_action();
  config.dead_band = 0.1;
  CHECK(drive_of({0.06, -0.06}, config) == Vector2(0.0, 0.0));
  CHECK(drive_of({0.05, -0.2}, config) == Vector2(0.75, -3.0));  // the weak axis gives the direction
}

TEST_CASE("a device that drives one axis at a time gets the larger component") {
  ActionConfig config = lodestone::tests::paper_action();
  config.one_axis_at_a_time = true;
  config.scale = 100.0;
  CHECK(drive_of({0.3, -0.4}, config) == Vector2(0.0, -40.0));
  CHECK(drive_of({0.5, 0.4}, config) == Vector2(50.0, 0.0));
}

TEST_CASE("actions are drawn of any strength and direction, and varied near another", "[unit]") {
  lodestone::common::RandomStream random(1, "actions");
  constexpr int kDrawn = 4000;
  int weak = 0, right = 0;
  for (int i = 0; i < kDrawn; ++i) {
    const lodestone::geometry::Drive action = lodestone::task::draw_action(2, 0.01, random);
    const double strength = action.cwiseAbs().maxCoeff();
    REQUIRE(strength >= 0.01 * (1.0 - 1e-12));
    REQUIRE(strength <= 1.0);
    weak += strength < 0.1 ? 1 : 0;
    right += action[0] > 0.0 ? 1 : 0;
  }
  CHECK(weak == Approx(kDrawn / 2).epsilon(0.1));  // as many below the middle of the logarithm as above
  CHECK(right == Approx(kDrawn / 2).epsilon(0.1));
  const lodestone::geometry::Drive action = {0.3, -0.4};
  double off = 0.0;
  for (int i = 0; i < kDrawn; ++i) {
    const lodestone::geometry::Drive near = lodestone::task::vary_action(action, 0.1, random);
    REQUIRE(near.cwiseAbs().maxCoeff() <= 1.0);
    off += (near - action).norm() / kDrawn;
  }
  CHECK(off > 0.03);
  CHECK(off < 0.12);
  CHECK(lodestone::task::draw_action(5, 0.5, random).size() == 5);
}
