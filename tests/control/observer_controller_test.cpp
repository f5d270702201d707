#include "lodestone/control/observer_controller.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "control/observing.h"
#include "lodestone/control/turn_in_place.h"
#include "other_rigs.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Pose2;
using geometry::Vector2;

namespace {

control::ObserverController controller_of(const control::ObserverConfig& config,
                                          const physics::RigDescription& rig = tests::paper_rig()) {
  return control::ObserverController(rig, config, 0.1, 0.2);
}

task::Observation asked_at(const Pose2& pose, const Vector2& target_m) {
  task::Observation observation;
  observation.pose = pose;
  observation.target_m = target_m;
  return observation;
}

/// The plain simulator as the rig, whose coils are stronger or weaker than described, and whose needle is
/// carried by so much in every step.
class World {
 public:
  World(const Pose2& start, double gain, const Vector2& carried_m = Vector2::Zero())
      : pose_(start), gain_(gain), carried_m_(carried_m) {}

  /// The mean distance to the target over the last `scored` of so many steps.
  double drive(control::Controller& controller, const Vector2& target_m, int steps, int scored) {
    controller.reset();
    task::Observation observation = asked_at(pose_, target_m);
    double sum_m = 0.0;
    for (int step = 0; step < steps; ++step) {
      observation.last_action = controller.act(observation);
      const Vector2 before_m = pose_.position_m();
      pose_ = model_.after(pose_, tests::paper_rig().coils.max_current_A * observation.last_action, gain_);
      pose_.x_m += carried_m_.x();
      pose_.y_m += carried_m_.y();
      observation.pose = pose_;
      observation.last_displacement_m = pose_.position_m() - before_m;
      if (step >= steps - scored) sum_m += (pose_.position_m() - target_m).norm();
    }
    return sum_m / scored;
  }

 private:
  control::PulseModel model_{tests::paper_rig(), 0.1, 0.2};
  Pose2 pose_;
  double gain_;
  Vector2 carried_m_;
};

double heading_error_rad(const Pose2& pose, double heading_rad) {
  return std::abs(geometry::wrap_angle(pose.heading_rad - heading_rad));
}

}  // namespace

TEST_CASE("the observer keeps the contract of a controller") {
  for (const control::ObserverConfig& config : {control::ObserverConfig{}, tests::observing()}) {
    control::ObserverController controller = controller_of(config);
    tests::check_controller(controller);
  }
}

TEST_CASE("the observer comes to its targets, also on a rig that is weaker or stronger than described") {
  control::ObserverController controller = controller_of(tests::observing());
  const Pose2 starts[] = {{0.015, -0.01, 1.0}, {-0.012, 0.004, -2.5}, {0.002, 0.018, 0.3}};
  for (const double gain : {0.7, 1.0, 1.3})
    for (const Pose2& start : starts)
      CHECK(World(start, gain).drive(controller, {-0.004, 0.006}, 60, 5) < 1.5e-3);
}

TEST_CASE("in a steady drift the observer holds its target more closely than without observing") {
  control::ObserverConfig config = tests::observing();
  config.gain_share = 0.0;
  config.stuck_growth = 1.0;
  const Pose2 start{0.0, 0.0, 3.0};
  const Vector2 drift_m(1.5e-3, 0.0);
  control::ObserverController observing = controller_of(config);
  config.disturbance_share = 0.0;
  control::ObserverController blind = controller_of(config);
  const double with_m = World(start, 1.0, drift_m).drive(observing, {0.0, 0.0}, 80, 40);
  const double without_m = World(start, 1.0, drift_m).drive(blind, {0.0, 0.0}, 80, 40);
  CHECK(without_m > 1e-3);
  CHECK(with_m < 0.7 * without_m);
}

TEST_CASE("within the boundary layer there is no pulse, which goes for where the target will be") {
  control::ObserverController controller = controller_of(tests::observing());
  task::Observation observation = asked_at({0.0, 0.0, 0.5}, {0.5e-3, 0.0});
  CHECK(controller.act(observation).isZero(0.0));
  observation.awaited = true;
  CHECK_FALSE(controller.act(observation).isZero(0.0));
  observation = asked_at({0.0, 0.0, 0.5}, {3e-3, 0.0});
  CHECK_FALSE(controller.act(observation).isZero(0.0));
  observation.ahead = {{{0.4e-3, 0.0}, 0.3}};
  CHECK(controller.act(observation).isZero(0.0));
  const control::PulseModel model(tests::paper_rig(), 0.1, 0.2);
  observation.ahead = {{{6e-3, 0.0}, 0.3}};
  const Pose2 then = model.after(observation.pose, 15.0 * controller.act(observation));
  CHECK(then.x_m == Approx(6e-3).margin(1.5e-3));
}

TEST_CASE("the drive grows while the needle is stuck, up to the full one, and is the model's again after") {
  control::ObserverConfig config = tests::observing();
  config.gain_share = 0.0;
  config.disturbance_share = 0.0;
  control::ObserverController controller = controller_of(config);
  task::Observation observation = asked_at({0.0, 0.0, 0.1}, {0.01, 0.0});
  const geometry::Drive first = controller.act(observation);
  observation.last_action = first;
  geometry::Drive action = controller.act(observation);
  CHECK(action.norm() == Approx(1.2 * first.norm()));
  for (int i = 0; i < 40; ++i) {
    observation.last_action = action;
    action = controller.act(observation);
  }
  CHECK(action.cwiseAbs().maxCoeff() == Approx(1.0));
  observation.last_action = action;
  observation.last_displacement_m = {0.004, 0.0};
  observation.pose.x_m = 0.004;
  control::ObserverController fresh = controller_of(config);
  CHECK(controller.act(observation) == fresh.act(observation));
}

TEST_CASE("a needle that turned, or that others drove, is not stuck") {
  control::ObserverController controller = controller_of(tests::observing());
  task::Observation observation = asked_at({0.0, 0.0, 0.1}, {0.01, 0.0});
  observation.last_action = controller.act(observation);
  observation.pose.x_m = 0.002;  // from elsewhere than where it was seen last
  observation.last_displacement_m = {0.001, 0.0};
  controller.act(observation);
  CHECK(controller.observer().gain() == 1.0);
  CHECK(controller.observer().disturbance_m().norm() == 0.0);
  control::ObserverConfig config = tests::observing();
  config.gain_share = 0.0;
  control::ObserverController turned = controller_of(config);
  observation = asked_at({0.0, 0.0, 0.1}, {0.01, 0.0});
  observation.last_action = turned.act(observation);
  observation.pose.heading_rad = 0.4;
  control::ObserverController fresh = controller_of(config);
  CHECK(turned.act(observation) == fresh.act(observation));
}

TEST_CASE("along a path with headings the drive is chosen by both errors, far from a pose by one") {
  const control::PulseModel model(tests::paper_rig(), 0.1, 0.2);
  const double wanted_rad = 0.5 * geometry::kPi;
  control::ObserverConfig config = tests::observing();
  config.heading_cost_mm = 0.0;
  control::ObserverController careless = controller_of(config);
  config.heading_cost_mm = 50.0;
  control::ObserverController careful = controller_of(config);
  task::Observation observation = asked_at({0.0, 0.0, 0.0}, {0.0, 0.0});
  observation.ahead = {{{1e-3, 0.0}, 0.3, wanted_rad}};
  const double without_rad =
      heading_error_rad(model.after(observation.pose, 15.0 * careless.act(observation)), wanted_rad);
  const double with_rad =
      heading_error_rad(model.after(observation.pose, 15.0 * careful.act(observation)), wanted_rad);
  CHECK(with_rad < without_rad - 0.3);

  task::Observation pose = asked_at({0.0, 0.0, 0.0}, {0.01, 0.0});
  control::ObserverController other = controller_of(config);
  careful.reset();
  const geometry::Drive to_point = other.act(pose);
  pose.target_heading_rad = wanted_rad;
  CHECK(careful.act(pose) == to_point);
  pose.target_m = {0.5e-3, 0.0};
  CHECK_FALSE(careful.act(pose).isZero(0.0));  // there, but not as it shall lie
}

TEST_CASE("an observer within a turning in place is not told of pulses that were not its own") {
  control::TurnConfig turn;
  turn.current_A = 1.0;
  const physics::RigDescription rig = tests::paper_rig();
  control::TurnInPlace both(
      std::make_unique<control::ObserverController>(rig, control::ObserverConfig{}, 0.1, 0.2), turn, rig,
      rig.coils.max_current_A);
  CHECK(both.clone() != nullptr);
  task::Observation observation = asked_at({0.0, 0.0, 0.0}, {0.5e-3, 0.0});
  observation.target_heading_rad = 1.0;
  const geometry::Drive turning = both.act(observation);
  CHECK(turning.norm() * rig.coils.max_current_A == Approx(1.0).margin(0.01));
  observation.target_heading_rad.reset();
  observation.last_action = turning;
  CHECK(both.act(observation).isZero(0.0));
}

TEST_CASE("the observer's drives have the size of their rig's") {
  for (const physics::DriveKind kind : {physics::DriveKind::kIndependent, physics::DriveKind::kField})
    for (const int numbers : {2, 3, 4}) {
      if (kind == physics::DriveKind::kIndependent && numbers > 2) continue;  // as many as there are coils
      physics::RigDescription rig = tests::ring_rig(8, 0.0, true);
      rig.drive.kind = kind;
      if (kind == physics::DriveKind::kField) rig.drive.field_numbers = numbers;
      control::ObserverController controller = controller_of(tests::observing(), rig);
      task::Observation observation = asked_at({0.0, 0.0, 0.2}, {0.01, 0.0});
      observation.last_action = geometry::Drive::Zero(rig.drive_size());
      const geometry::Drive action = controller.act(observation);
      REQUIRE(action.size() == rig.drive_size());
      const control::PulseModel model(rig, 0.1, 0.2);
      CHECK(model.after(observation.pose, rig.coils.max_current_A * action).x_m > 0.002);
      observation.target_m = {0.0, 0.0};
      CHECK(controller.act(observation) == observation.rest());
    }
}
