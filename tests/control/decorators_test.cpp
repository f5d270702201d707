#include "lodestone/control/decorators.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "control/fakes.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

std::unique_ptr<control::Controller> constant(double x, double y) {
  return std::make_unique<tests::FunctionController>([=](const task::Observation&) { return Vector2(x, y); });
}

task::Observation after(const Vector2& action, double moved_m, const Vector2& position_m = {0.02, 0.0}) {
  task::Observation observation;
  observation.pose = {position_m.x(), position_m.y(), 0.0};
  observation.last_action = action;
  observation.last_displacement_m = {moved_m, 0.0};
  return observation;
}

}  // namespace

TEST_CASE("the adaptive gain grows while the needle stalls and returns to one after motion") {
  control::DecoratorConfig config;
  config.stall_gain = 1.2;
  control::AdaptiveGain controller(constant(0.1, 0.05), config);
  controller.reset();
  Vector2 action = controller.act(after({0.0, 0.0}, 0.0));
  CHECK(action.x() == Approx(0.1));
  action = controller.act(after(action, 0.0003));
  CHECK(action.x() == Approx(0.12));
  action = controller.act(after(action, 0.0));
  CHECK(action.x() == Approx(0.144));
  CHECK(action.y() == Approx(0.072));
  SECTION("motion") {
    CHECK(controller.act(after(action, 0.004)).x() == Approx(0.1));
    CHECK(controller.gain() == 1.0);
  }
  SECTION("a turn is motion") {
    task::Observation turned = after(action, 0.0);
    turned.pose.heading_rad = 0.5;
    CHECK(controller.act(turned).x() == Approx(0.1));
  }
  SECTION("a step without command says nothing") {
    CHECK(controller.act(after({0.0, 0.0}, 0.0)).x() == Approx(0.144));
  }
  SECTION("a limit keeps the direction") {
    for (int i = 0; i < 50; ++i) action = controller.act(after(action, 0.0));
    CHECK(controller.gain() == config.stall_gain_max);
    CHECK(action.x() == Approx(0.8));
    CHECK(action.y() == Approx(0.4));
  }
  SECTION("reset") {
    controller.reset();
    CHECK(controller.act(after(action, 0.0)).x() == Approx(0.1));
  }
}

TEST_CASE("hold gives no current within its radius") {
  control::DecoratorConfig config;
  config.hold_radius_m = 0.002;
  control::Hold controller(constant(0.3, 0.0), config);
  CHECK(controller.act(after({0, 0}, 0.0, {0.0015, 0.001})).isZero(0.0));
  CHECK(controller.act(after({0, 0}, 0.0, {0.0025, 0.0})).x() == 0.3);
}

TEST_CASE("a needle is led to where its target will be, but not around a corner") {
  control::DecoratorConfig config;
  config.lead_s = 1.5;
  auto inner =
      std::make_unique<tests::FunctionController>([](const task::Observation&) { return Vector2(0.0, 0.0); });
  const tests::FunctionController& asked = *inner;
  control::Lead controller(std::move(inner), config);
  task::Observation observation;
  observation.target_m = {0.0, 0.0};
  controller.act(observation);
  CHECK(asked.seen.back().target_m.isZero(0.0));  // it stays
  for (int step = 1; step <= 10; ++step) observation.ahead.push_back({{0.001 * step, 0.0}, 0.4 * step});
  controller.act(observation);
  CHECK((asked.seen.back().target_m - Vector2(0.00375, 0.0)).norm() < 1e-12);
  CHECK(asked.seen.back().ahead.empty());  // nobody leads it once more
  for (int step = 3; step <= 10; ++step) observation.ahead[step - 1].point_m = {0.002, 0.001 * (step - 2)};
  controller.act(observation);
  CHECK((asked.seen.back().target_m - Vector2(0.002, 0.0)).norm() < 1e-12);  // the corner
  observation.target_m = {0.002, 0.0};
  observation.ahead.erase(observation.ahead.begin(), observation.ahead.begin() + 2);
  for (task::TargetAhead& point : observation.ahead) point.in_s -= 0.8;
  controller.act(observation);
  CHECK((asked.seen.back().target_m - Vector2(0.002, 0.00375)).norm() < 1e-12);
}

TEST_CASE("a needle that is led is led to the heading that it shall have there") {
  control::DecoratorConfig config;
  config.lead_s = 0.5;
  auto inner =
      std::make_unique<tests::FunctionController>([](const task::Observation&) { return Vector2(0.0, 0.0); });
  const tests::FunctionController& asked = *inner;
  control::Lead controller(std::move(inner), config);
  task::Observation observation;
  observation.target_heading_rad = 0.1;
  controller.act(observation);
  CHECK(asked.seen.back().target_heading_rad == 0.1);
  observation.ahead = {{{0.001, 0.0}, 0.4, 0.2}, {{0.002, 0.0}, 0.8, 0.3}, {{0.003, 0.0}, 1.2, 0.4}};
  controller.act(observation);
  CHECK((asked.seen.back().target_m - Vector2(0.00125, 0.0)).norm() < 1e-12);
  CHECK(asked.seen.back().target_heading_rad == 0.3);
}

TEST_CASE("decorators that are off leave the controller as it is") {
  auto inner = constant(0.3, 0.0);
  control::Controller* raw = inner.get();
  CHECK(control::decorate(std::move(inner), {}).get() == raw);
}

TEST_CASE("a full command that moves nothing is dithered from side to side until something moves") {
  control::DecoratorConfig config;
  config.stall_gain = 2.0;
  config.direction_dither_deg = 30.0;
  control::AdaptiveGain controller(constant(0.8, 0.0), config);
  controller.reset();
  task::Observation observation;
  const auto angle_deg = [&] {
    const geometry::Vector2 action = controller.act(observation);
    observation.last_action = action;
    return std::atan2(action.y(), action.x()) * 180.0 / 3.14159265358979323846;
  };
  CHECK(angle_deg() == Approx(0.0).margin(1e-9));  // 0.8
  for (int i = 0; i < 3; ++i)
    CHECK(angle_deg() == Approx(0.0).margin(1e-9));  // the full command, tried thrice
  CHECK(angle_deg() == Approx(30.0));
  CHECK(angle_deg() == Approx(-30.0));
  CHECK(angle_deg() == Approx(60.0));
  CHECK(angle_deg() == Approx(-60.0));
  observation.last_displacement_m = {0.01, 0.0};
  CHECK(angle_deg() == Approx(0.0).margin(1e-9));
}

TEST_CASE("a dithered command may be weaker than the full one, and still counts as one") {
  control::DecoratorConfig config;
  config.stall_gain = 1.2;
  config.direction_dither_deg = 30.0;
  config.direction_dither_fraction = 0.1;
  control::AdaptiveGain controller(constant(1.0, 0.0), config);
  controller.reset();
  Vector2 action = controller.act(after({0.0, 0.0}, 0.0));
  for (int step = 0; step < 3; ++step) action = controller.act(after(action, 0.0));
  // The third stall in a row of a full command: 30 degrees to one side, a tenth as strong.
  CHECK(action.cwiseAbs().maxCoeff() == Approx(0.1));
  CHECK(std::abs(action.y() / action.x()) == Approx(std::tan(30.0 * 3.14159265358979 / 180.0)));
  const Vector2 next = controller.act(after(action, 0.0));
  CHECK(next.y() == Approx(-action.y()));  // to the other side
}

TEST_CASE("holding waits for the heading where the target has one") {
  control::DecoratorConfig config;
  config.hold_radius_m = 0.002;
  config.hold_heading_deg = 8.0;
  const auto controller = control::decorate(constant(0.5, 0.5), config);
  task::Observation observation = after({0.0, 0.0}, 0.0, {0.001, 0.0});
  CHECK(controller->act(observation).isZero(0.0));
  observation.target_heading_rad = 0.3;
  CHECK_FALSE(controller->act(observation).isZero(0.0));
  observation.pose.heading_rad = 0.25;
  CHECK(controller->act(observation).isZero(0.0));
}

TEST_CASE("a decorated controller keeps the contract") {
  control::DecoratorConfig config;
  config.stall_gain = 1.2;
  config.hold_radius_m = 0.002;
  config.direction_dither_deg = 30.0;
  config.lead_s = 1.0;
  tests::check_controller(*control::decorate(constant(0.7, -0.4), config));
}
