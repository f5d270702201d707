#include "lodestone/control/pulse_model.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "other_rigs.h"
#include "paper_rig.h"

using namespace lodestone;

TEST_CASE("a modelled pulse pulls the needle to its coil, and friction holds it against a weak one") {
  const control::PulseModel model(tests::paper_rig(), 0.1, 0.2);
  const geometry::Pose2 pose{0.0, 0.0, 0.0};
  const auto x_m = [&](double drive_A, double gain) { return model.after(pose, {drive_A, 0.0}, gain).x_m; };
  CHECK(x_m(0.0, 1.0) == 0.0);
  CHECK(x_m(0.1, 1.0) == 0.0);
  double drive_A = 0.1;
  while (x_m(drive_A, 1.0) <= 0.0 && drive_A < 15.0) drive_A *= 1.1;
  CHECK(drive_A < 15.0);
  CHECK(x_m(1.1 * drive_A, 1.0) > x_m(drive_A, 1.0));
  CHECK(x_m(0.5 * drive_A, 2.0) == Approx(x_m(drive_A, 1.0)));
  CHECK_THROWS_AS(model.after(pose, geometry::Drive::Zero(3)), common::LogicFault);
}

TEST_CASE("the strongest action of a direction has the size of the rig's drive") {
  const double up_rad = 0.5 * geometry::kPi;
  for (const physics::DriveKind kind : {physics::DriveKind::kIndependent, physics::DriveKind::kField}) {
    physics::RigDescription rig = tests::ring_rig(8, 0.0, true);
    rig.drive.kind = kind;
    const control::PulseModel model(rig, 0.1, 0.2);
    const geometry::Drive action = model.full_action(up_rad, {0.0, 0.0});
    REQUIRE(action.size() == rig.drive_size());
    CHECK(action.cwiseAbs().maxCoeff() == Approx(1.0));
    const geometry::Pose2 then = model.after({0.0, 0.0, up_rad}, rig.coils.max_current_A * action);
    CHECK(then.y_m > 0.0);
    CHECK(std::abs(then.x_m) < 0.2 * then.y_m);
  }
}
