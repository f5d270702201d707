#include "lodestone/control/dipole_pull.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "other_rigs.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

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

TEST_CASE("whatever drives the coils, the baseline pulls where it is asked to") {
  for (const physics::DriveKind kind : {physics::DriveKind::kIndependent, physics::DriveKind::kField})
    for (const int numbers : {2, 3, 4}) {
      if (kind == physics::DriveKind::kIndependent && numbers > 2) continue;  // as many as there are coils
      physics::RigDescription rig = tests::ring_rig(8, 0.0, true);
      rig.drive.kind = kind;
      if (kind == physics::DriveKind::kField) rig.drive.field_numbers = numbers;
      const control::DipolePull model(rig);
      for (const double angle : {0.3, 1.2, 2.5, -2.0, -0.4}) {
        const Vector2 wanted = 2e-4 * Vector2(std::cos(angle), std::sin(angle));
        const Vector2 position(0.004, -0.003);
        const geometry::Drive drive_A = model.drive_A(wanted, position);
        CHECK(drive_A.size() == rig.drive_size());
        CHECK((model.pull_N(drive_A, position) - wanted).norm() < 0.05 * wanted.norm());
      }
      control::DipolePullController controller(rig, {});
      task::Observation observation;
      observation.last_action = geometry::Drive::Zero(rig.drive_size());
      observation.target_m = {0.01, 0.0};
      const geometry::Drive action = controller.act(observation);
      REQUIRE(action.size() == rig.drive_size());
      CHECK(model.pull_N(rig.coils.max_current_A * action, {0.0, 0.0}).x() > 0.0);
      observation.target_m = {0.0, 0.0};
      CHECK(controller.act(observation) == observation.rest());
    }
}

TEST_CASE("the baseline keeps the contract") {
  control::DipolePullController controller(tests::paper_rig(), {});
  tests::check_controller(controller);
}

TEST_CASE("the baseline pulls to where its target will be after the pulse, and rests when it is close") {
  control::DipolePullConfig config;
  config.rest_radius_m = 0.5e-3;
  control::DipolePullController controller(tests::paper_rig(), config);
  task::Observation observation;
  observation.target_m = {0.01, 0.0};
  CHECK(controller.act(observation).x() > 0.0);
  observation.ahead = {{{-0.01, 0.0}, 0.3}, {{0.02, 0.0}, 0.6}};
  CHECK(controller.act(observation).x() < 0.0);
  observation.ahead.front().point_m = {0.4e-3, 0.0};
  CHECK(controller.act(observation).isZero(0.0));
}

TEST_CASE("a disturbance observer pulls harder at a needle that stays behind, and no harder than it must") {
  control::DipolePullConfig config;
  config.gain_N_m = 0.01;
  config.observer_share = 0.5;
  config.mobility_m_per_N = 20.0;
  control::DipolePullController controller(tests::paper_rig(), config);
  const double expected_m = config.mobility_m_per_N * config.gain_N_m * 0.01;
  task::Observation observation;
  // The pull at the centre after a pulse that took the needle there; the target is always 10 mm ahead.
  const auto pull = [&](double moved_m) {
    observation.pose.x_m = -moved_m;
    observation.target_m = {0.01 - moved_m, 0.0};
    observation.last_displacement_m = {moved_m, 0.0};
    const geometry::Vector2 before = observation.last_action;
    observation.last_action.setZero();  // says nothing
    const geometry::Vector2 given = controller.act(observation);
    observation.last_action = before.isZero(0.0) ? before : given;
    observation.pose.x_m = 0.0;
    observation.target_m = {0.01, 0.0};
    return (observation.last_action = controller.act(observation)).x();
  };
  const double first = pull(0.0);
  CHECK(first > 0.0);
  CHECK(pull(expected_m) == Approx(first));
  const double after_a_stall = pull(0.0);
  CHECK(after_a_stall > 1.1 * first);
  CHECK(pull(0.0) > after_a_stall);
  CHECK(pull(3.0 * expected_m) < after_a_stall);
  controller.reset();
  observation.last_action.setZero();
  CHECK(pull(0.0) == first);
  for (int step = 0; step < 50; ++step) pull(0.0);
  for (int step = 0; step < 5; ++step) pull(20.0 * expected_m);
  CHECK(pull(expected_m) < first);  // however long it stayed, what was added is taken back
}
