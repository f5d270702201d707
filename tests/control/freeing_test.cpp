#include "lodestone/control/freeing.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/geometry/angle.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/task/action.h"
#include "paper_rig.h"
#include "sphere_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kMoved_m = 0.0015;

/// Pulses until the needle has moved; one more than may be where it has not.
std::int64_t pulses_to_free(rig::VirtualRig& rig, const geometry::Pose2& start) {
  rig.place(start);
  control::Freeing freeing({}, rig.config());
  std::int64_t pulses = 0;
  while ((rig.true_pose().position_m() - start.position_m()).norm() < kMoved_m) {
    ++pulses;
    if (freeing.failed()) break;
    const Vector2 drive_A = task::drive_of(freeing.next(rig.true_pose()), tests::paper_action());
    rig.coils().apply({physics::opposed_pairs_A(drive_A), 0.1});
    rig.clock().sleep_until(rig.clock().now_s() + 0.3);
  }
  return pulses;
}

/// At the wall in direction `at_rad`, the needle along the wall or with its head at it.
geometry::Pose2 at_wall(const rig::VirtualRig& rig, double at_rad, double heading_rad) {
  geometry::Pose2 pose{0.0, 0.0, heading_rad};
  for (double radius_m = rig.config().dish.radius_m; radius_m > 0.0; radius_m -= 0.0001) {
    pose.x_m = radius_m * std::cos(at_rad);
    pose.y_m = radius_m * std::sin(at_rad);
    if (rig.fits(pose)) break;
  }
  return pose;
}

}  // namespace

TEST_CASE("a needle at the wall gets free, wherever and however it lies") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    rig::VirtualRigConfig config;
    config.simulation.deviation = seed == 1 ? rig::DeviationWidth::kLab : rig::DeviationWidth::kWide;
    rig::VirtualRig rig(config, seed);
    for (int at = 0; at < 8; ++at)
      for (int turned = 0; turned < 2; ++turned) {
        const double at_rad = at * geometry::kPi / 4.0;
        const std::int64_t pulses =
            pulses_to_free(rig, at_wall(rig, at_rad, at_rad + turned * geometry::kPi / 2.0));
        CAPTURE(seed, at, turned, pulses);
        CHECK(pulses <= control::FreeingConfig().max_pulses);
      }
  }
}

TEST_CASE("pulls grow to the largest current, go to both sides, and turns come between") {
  control::FreeingConfig config;
  config.dither_deg = 45.0;
  config.max_pulses = 100;
  const physics::RigDescription rig = tests::paper_rig();
  control::Freeing freeing(config, rig);
  const geometry::Pose2 pose{0.01, 0.0, 1.0};
  const control::DipolePull pull(rig);
  const auto direction_deg = [&](const Vector2& action) {
    const Vector2 force_N = pull.pull_N(rig.coils.max_current_A * action, pose.position_m());
    return geometry::kDegPerRad * std::atan2(force_N.y(), force_N.x());
  };
  double before = 0.0;
  Vector2 action = freeing.next(pose);
  for (; action.cwiseAbs().maxCoeff() < 1.0; action = freeing.next(pose)) {
    CHECK(std::abs(direction_deg(action)) > 170.0);
    CHECK(action.norm() > before);
    before = action.norm();
  }
  CHECK(before > 0.0);
  const Vector2 left = freeing.next(pose);
  const Vector2 right = freeing.next(pose);
  CHECK(left.cwiseAbs().maxCoeff() == 1.0);
  CHECK(left.x() == Approx(right.x()).margin(1e-9));
  CHECK(left.y() == Approx(-right.y()));
  CHECK(std::abs(left.y()) > 0.1);
  freeing.next(pose);
  freeing.next(pose);
  for (int turn = 0; turn < 2; ++turn)
    CHECK(freeing.next(pose).norm() == Approx(config.turn_A / rig.coils.max_current_A));
  CHECK(freeing.next(pose) == action);  // a round is over
  control::Freeing resumed(config, rig);
  resumed.restore(freeing.save());
  CHECK(resumed.next(pose) == freeing.next(pose));
  freeing.reset();
  CHECK(freeing.next(pose).cwiseAbs().maxCoeff() < 1.0);
}

TEST_CASE("a sphere is pulled free, and never turned") {
  const physics::RigDescription rig = tests::sphere_rig();
  control::FreeingConfig config;
  config.max_pulses = 100;
  control::Freeing freeing(config, rig);
  const geometry::Pose2 pose{0.02, 0.01, 0.0};
  while (freeing.next(pose).cwiseAbs().maxCoeff() < 1.0) {
  }
  for (int i = 0; i < 30; ++i)
    CHECK(freeing.next(pose).norm() > 2.0 * config.turn_A / rig.coils.max_current_A);
}
