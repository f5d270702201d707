#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "control/fakes.h"
#include "inference/random_policy.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/control/policy_controller.h"
#include "paper_rig.h"

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

inference::Policy small_policy() {
  inference::Policy policy;
  policy.encoder = tests::paper_encoder();
  policy.action = tests::paper_action();
  policy.encoder.memory = true;
  policy.hidden = {16, 16};
  tests::draw_weights(policy, 4);
  return policy;
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

TEST_CASE("decorators that are off leave the controller as it is") {
  auto inner = constant(0.3, 0.0);
  control::Controller* raw = inner.get();
  CHECK(control::decorate(std::move(inner), {}).get() == raw);
}

TEST_CASE("the simulator's pull points where it is asked to") {
  const physics::RigDescription rig = tests::paper_rig();
  const control::DipolePull model(rig);
  SECTION("one coil pulls the needle to itself, twice the current twice as hard") {
    const Vector2 pull = model.pull_N({4.0, 0.0}, {0.0, 0.0});
    CHECK(pull.x() > 0.0);
    CHECK(std::abs(pull.y()) < 1e-12);
    CHECK(model.pull_N({8.0, 0.0}, {0.0, 0.0}).x() == Approx(2.0 * pull.x()));
    // On the axis of a dipole B = mu0 m / 2 pi d^3, so dB/dx = 3 B / d.
    const physics::DipoleCoil coil(rig.coils.geometry, 0);
    const double field_T = 2e-7 * coil.moment_per_ampere_m2() * 4.0 / std::pow(0.08, 3);
    CHECK(pull.x() == Approx(rig.needle.moment_A_m2 * 3.0 * field_T / 0.08).epsilon(1e-6));
  }
  SECTION("the inverse gives the pull back") {
    for (const double angle : {0.3, 1.2, 2.5, -2.0, -0.4}) {
      const Vector2 wanted = 2e-4 * Vector2(std::cos(angle), std::sin(angle));
      const Vector2 position(0.004, -0.003);
      const Vector2 got = model.pull_N(model.drive_A(wanted, position), position);
      CHECK((got - wanted).norm() < 2e-3 * wanted.norm());
    }
  }
}

TEST_CASE("controllers keep the contract") {
  SECTION("baseline") {
    control::DipolePullController controller(tests::paper_rig(), {});
    tests::check_controller(controller);
  }
  SECTION("policy, decorated") {
    control::DecoratorConfig config;
    config.stall_gain = 1.2;
    config.hold_radius_m = 0.002;
    auto controller = control::decorate(std::make_unique<control::PolicyController>(small_policy()), config);
    tests::check_controller(*controller);
  }
}

TEST_CASE("the policy controller computes what the network computes") {
  const inference::Policy policy = small_policy();
  control::PolicyController controller(policy);
  const task::Observation observation = after({0.2, -0.1}, 0.001);
  const task::ObservationEncoder encoder(policy.encoder);
  std::vector<float> input(static_cast<std::size_t>(encoder.size()));
  encoder.encode(observation, input.data());
  float expected[2];
  inference::Actor::Workspace workspace;
  policy.actor().act(input.data(), 1, expected, workspace);
  const Vector2 action = controller.act(observation);
  CHECK(action.x() == expected[0]);
  CHECK(action.y() == expected[1]);
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
