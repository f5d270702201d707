#include "lodestone/control/turn_in_place.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "control/fakes.h"
#include "lodestone/control/reference.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

control::TurnConfig config() {
  control::TurnConfig turn;
  turn.current_A = 1.0;
  return turn;
}

control::TurnInPlace turner(const control::TurnConfig& turn = config()) {
  return control::TurnInPlace(std::make_unique<tests::FunctionController>(
                                  [](const task::Observation&) { return Vector2(0.5, -0.5); }),
                              turn, tests::paper_rig(), 10.0);
}

task::Observation seen_at(double x_m, double heading_rad, double target_heading_rad) {
  task::Observation observation;
  observation.pose = {x_m, 0.0, heading_rad};
  observation.target_heading_rad = target_heading_rad;
  return observation;
}

}  // namespace

TEST_CASE("a needle at its target is turned by a weak field along the wanted heading") {
  control::TurnInPlace controller = turner();
  tests::check_controller(controller);
  controller.reset();
  // At the centre the field points where the drives do.
  Vector2 action = controller.act(seen_at(0.0, 1.0, 2.0));
  CHECK(action.norm() == Approx(0.1));  // 1 A of 10
  CHECK(std::atan2(action.y(), action.x()) == Approx(2.0).margin(0.02));
  // A field opposite to the needle would not turn it: it leads by 70 degrees at most.
  action = controller.act(seen_at(0.0, -1.0, 2.0));
  CHECK(std::atan2(action.y(), action.x()) == Approx(-1.0 + 70.0 / 57.29578).margin(0.02));
  CHECK_FALSE(controller.act(seen_at(0.0025, 0.0, 2.0)) == Vector2(0.5, -0.5));  // still there
  CHECK(controller.act(seen_at(0.0035, 0.0, 2.0)) == Vector2(0.5, -0.5));        // no more
  CHECK(controller.act(seen_at(0.0025, 0.0, 2.0)) == Vector2(0.5, -0.5));        // not yet again
  CHECK(controller.act(seen_at(0.001, 1.95, 2.0)).isZero(0.0));                  // there, and turned
  task::Observation point = seen_at(0.0, 0.0, 2.0);
  point.target_heading_rad.reset();
  CHECK(controller.act(point) == Vector2(0.5, -0.5));
}

TEST_CASE("along a path no needle is turned in place, nor on the way to its start") {
  control::TurnInPlace controller = turner();
  controller.reset();
  control::PathReferenceConfig config;
  config.approach_radius_m = 0.0005;
  control::PathReference path(
      geometry::Path({{0.0, 0.0}, {0.02, 0.0}}, false).with_heading(geometry::PathHeading::fixed(2.0)),
      config);
  task::Observation observation = seen_at(0.001, 0.0, 2.0);
  CHECK_FALSE(controller.act(observation) == Vector2(0.5, -0.5));  // a pose
  for (const double x_m : {0.001, 0.0}) {
    observation.pose.x_m = x_m;
    observation.target_m = path.target(1.0, observation.pose);
    CHECK(path.approaching() == (x_m > 0.0));
    observation.target_heading_rad = path.target_heading_rad();
    observation.ahead = path.ahead(1.0, 0.3, 5);
    CHECK(controller.act(observation) == Vector2(0.5, -0.5));
  }
}

TEST_CASE("the current grows while the needle does not turn, and starts over when it does") {
  control::TurnInPlace controller = turner();
  controller.reset();
  CHECK(controller.act(seen_at(0.0, 0.0, 1.0)).norm() == Approx(0.1));
  CHECK(controller.act(seen_at(0.0, 0.01, 1.0)).norm() == Approx(0.125));
  CHECK(controller.act(seen_at(0.0, 0.01, 1.0)).norm() == Approx(0.15625));
  CHECK(controller.act(seen_at(0.0, 0.3, 1.0)).norm() == Approx(0.1));
  for (int i = 0; i < 20; ++i) controller.act(seen_at(0.0, 0.3, 1.0));
  CHECK(controller.act(seen_at(0.0, 0.3, 1.0)).norm() == Approx(0.3));  // never more than that
}

TEST_CASE("off the centre the drives make up for the coils' distances") {
  const control::TurnInPlace controller = turner();
  // 45 degrees close to the +x coil: its own drive must be the smaller one.
  const Vector2 drive = controller.drive_along(3.14159265358979 / 4.0, {0.02, 0.0});
  CHECK(drive.x() > 0.0);
  CHECK(drive.y() > drive.x());
}
