#include "lodestone/control/disturbance_observer.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/observing.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

const geometry::Drive kNoDrive = geometry::Drive::Zero(2);

std::shared_ptr<const control::PulseModel> described() {
  return std::make_shared<const control::PulseModel>(tests::paper_rig(), 0.1, 0.2);
}

/// A needle that lies along its pull, towards +x or -x.
geometry::Pose2 lying_along(double sign) { return {0.0, 0.0, sign > 0.0 ? 0.0 : geometry::kPi}; }

Vector2 motion_of_m(const control::PulseModel& by, double drive_A, double gain) {
  return by.after(lying_along(drive_A), {drive_A, 0.0}, gain).position_m();
}

/// The drive that takes a needle at the centre 3 mm or a little more towards +x, on a rig of some gain.
double drive_for_3_mm_A(const control::PulseModel& by, double gain) {
  double drive_A = 0.1;
  while (drive_A < 15.0 && motion_of_m(by, drive_A, gain).x() < 0.003) drive_A *= 1.01;
  return drive_A;
}

}  // namespace

TEST_CASE("pulses that fall short tell the gain of a rig") {
  const auto known = described();
  control::DisturbanceObserver observer(known, tests::observing());
  for (const double gain : {0.7, 1.3}) {
    observer.reset();
    CHECK(observer.gain() == 1.0);
    const double drive_A = drive_for_3_mm_A(*known, gain);
    for (int i = 0; i < 30; ++i) {
      const double signed_A = i % 2 == 0 ? drive_A : -drive_A;
      observer.learn(lying_along(signed_A), {signed_A, 0.0}, motion_of_m(*known, signed_A, gain));
    }
    CHECK(observer.gain() == Approx(gain).epsilon(0.1));
    const geometry::Pose2 then = observer.after(lying_along(1.0), {drive_A, 0.0});
    CHECK(then.x_m == Approx(motion_of_m(*known, drive_A, gain).x()).margin(2e-3));
  }
}

TEST_CASE(
    "what carries the needle whatever the drive is learned as a disturbance, and forgotten when it ends") {
  const auto known = described();
  control::ObserverConfig config = tests::observing();
  config.gain_share = 0.0;
  control::DisturbanceObserver observer(known, config);
  const Vector2 flow_m(0.5e-3, -1.5e-3);
  const double drive_A = drive_for_3_mm_A(*known, 1.0);
  for (int i = 0; i < 30; ++i)
    observer.learn(lying_along(1.0), {drive_A, 0.0}, motion_of_m(*known, drive_A, 1.0) + flow_m);
  CHECK((observer.disturbance_m() - flow_m).norm() < 0.1e-3);
  CHECK(observer.drift_m().norm() == 0.0);  // nobody has seen a rest
  const geometry::Pose2 then = observer.after(lying_along(1.0), {drive_A, 0.0});
  CHECK((then.position_m() - motion_of_m(*known, drive_A, 1.0) - flow_m).norm() < 0.1e-3);
  CHECK(observer.after(lying_along(1.0), kNoDrive).position_m().norm() == 0.0);
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), kNoDrive, flow_m);
  CHECK((observer.drift_m() - flow_m).norm() < 0.1e-3);
  CHECK((observer.after(lying_along(1.0), kNoDrive).position_m() - flow_m).norm() < 0.1e-3);
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), kNoDrive, Vector2::Zero());
  CHECK(observer.drift_m().norm() < 0.1e-3);
  CHECK(observer.disturbance_m().norm() < 0.1e-3);
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), kNoDrive, {0.05, 0.0});
  CHECK(observer.drift_m().norm() <= config.most_disturbance_m + 1e-12);
}

TEST_CASE("a needle that is stuck winds nothing up") {
  const auto known = described();
  control::DisturbanceObserver observer(known, tests::observing());
  const double drive_A = drive_for_3_mm_A(*known, 1.0);
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), {drive_A, 0.0}, Vector2::Zero());
  const double gain = observer.gain();
  CHECK(observer.disturbance_m().norm() == 0.0);
  CHECK(gain < 1.0);
  CHECK(motion_of_m(*known, drive_A, gain).norm() < 0.5e-3);        // at which the model is stuck, too,
  CHECK(motion_of_m(*known, drive_A, 1.1 * gain).norm() > 0.1e-3);  // and only just
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), {drive_A, 0.0}, Vector2::Zero());
  CHECK(observer.gain() == Approx(gain).epsilon(0.02));
  for (int i = 0; i < 30; ++i) observer.learn(lying_along(1.0), {0.1, 0.0}, Vector2::Zero());
  CHECK(observer.gain() == Approx(gain).epsilon(0.02));  // so weak a pulse tells nothing
}

TEST_CASE("a pulse against a flow that keeps the needle where it is has moved it") {
  control::DisturbanceObserver observer(described(), tests::observing());
  CHECK(observer.stuck(Vector2::Zero()));
  for (int i = 0; i < 20; ++i) observer.learn(lying_along(1.0), kNoDrive, {1e-3, 0.0});
  CHECK_FALSE(observer.stuck(Vector2::Zero()));
  CHECK(observer.stuck({1e-3, 0.0}));
}
