#include "lodestone/control/recovery.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/fakes.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/safety/supervisor.h"
#include "sphere_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

double direction_rad(const Vector2& vector) { return std::atan2(vector.y(), vector.x()); }

/// Sees the needle, but from a moment on only after it has turned since: what a reflection does that lies on
/// it.
class HiddenUntilTurned final : public control::PoseSensor {
 public:
  explicit HiddenUntilTurned(rig::VirtualRig& rig) : rig_(rig) {}
  control::PoseEstimate observe() override {
    control::PoseEstimate estimate;
    estimate.pose = rig_.true_pose();
    estimate.stamp_s = rig_.clock().now_s();
    if (hidden_at_rad && std::abs(geometry::wrap_angle(estimate.pose.heading_rad - *hidden_at_rad)) > 0.1)
      hidden_at_rad.reset();
    estimate.valid = !hidden_at_rad;
    if (hidden_at_rad) estimate.reason = "a reflection";
    return estimate;
  }
  std::optional<double> hidden_at_rad;

 private:
  rig::VirtualRig& rig_;
};

}  // namespace

TEST_CASE("a needle that is not seen is waited for, turned to both sides, and pulled to the centre at last") {
  const physics::RigDescription rig;
  control::Recovery recovery({}, rig);
  const control::DrivenField field(rig);
  const geometry::Pose2 last{0.015, 0.01, 0.4};
  recovery.seen(last);
  std::vector<Vector2> probes_A;
  std::vector<int> at;
  for (int step = 1; step <= 30; ++step)
    if (const auto probe_A = recovery.next_probe()) {
      probes_A.push_back(*probe_A);
      at.push_back(step);
    }
  CHECK(at == std::vector<int>{2, 4, 6, 8, 10, 12});
  REQUIRE(probes_A.size() == 6);
  for (std::size_t i = 0; i < 4; ++i) {
    const double turn_rad =
        direction_rad(field.at(probes_A[i], last.position_m()).field_T) - last.heading_rad;
    CHECK(geometry::kDegPerRad * turn_rad == Approx(i % 2 == 0 ? 60.0 : -60.0).margin(1.0));
    CHECK(probes_A[i].norm() == Approx(i < 2 ? 1.0 : 1.5));
  }
  const Vector2 pull_N = control::DipolePull(rig).pull_N(probes_A[4], last.position_m());
  CHECK(pull_N.dot(-last.position_m()) > 0.9 * pull_N.norm() * last.position_m().norm());
  for (const Vector2& probe_A : probes_A) CHECK(probe_A.cwiseAbs().maxCoeff() <= 2.0 + 1e-12);
  recovery.seen(last);
  CHECK_FALSE(recovery.next_probe());
  CHECK(recovery.next_probe());
}

TEST_CASE("a needle that was never seen is turned, and not pulled anywhere") {
  control::Recovery recovery({}, {});
  int probes = 0;
  for (int step = 0; step < 30; ++step) probes += recovery.next_probe() ? 1 : 0;
  CHECK(probes == 4);
}

TEST_CASE("a sphere looks the same when it has turned: it is waited for, and pulled to the centre") {
  control::Recovery recovery({}, tests::sphere_rig());
  recovery.seen({0.015, 0.01, 0.0});
  std::vector<int> at;
  for (int step = 1; step <= 30; ++step)
    if (const auto probe_A = recovery.next_probe()) {
      at.push_back(step);
      CHECK(probe_A->dot(Vector2(-0.015, -0.01)) > 0.0);
    }
  CHECK(at == std::vector<int>{2, 4});
}

TEST_CASE("what hides a needle that lies still is gone when it has turned: the run goes on") {
  rig::VirtualRig rig(rig::VirtualRigConfig{}, 1);
  rig.place({0.012, -0.008, 0.6});
  HiddenUntilTurned sensor(rig);
  safety::Supervisor coils(rig.coils(), {}, rig.config(), rig.clock());
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.2, 0.1); });
  const auto run = [&](const physics::RigDescription* looks_for_it) {
    task::ActionConfig weak;  // it lies still
    weak.scale = 1e-3;
    control::ControlLoop loop({}, weak, coils, sensor, rig.clock(), looks_for_it);
    control::PointReference reference({0.0, 0.0}, 12.0);
    int steps = 0;
    return loop.run(controller, reference, [&](const control::StepRecord& record) {
      if (++steps == 3) sensor.hidden_at_rad = record.estimate.pose.heading_rad;
    });
  };
  SECTION("with somebody who looks for it") {
    const control::LoopOutcome outcome = run(&rig.config());
    CHECK(outcome.stop_reason.empty());
    int probes = 0;
    for (const control::StepRecord& step : outcome.steps) {
      probes += step.probe ? 1 : 0;
      if (step.probe) CHECK_FALSE(step.estimate.valid);
    }
    CHECK(probes >= 1);
    CHECK(probes <= 6);
    CHECK(outcome.steps.back().estimate.valid);
  }
  SECTION("without") { CHECK_THAT(run(nullptr).stop_reason, Catch::Contains("no pose for")); }
}
