#include <catch2/catch.hpp>

#include <cmath>

#include "control/fakes.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/session/simulated_detector.h"
#include "lodestone/session/tracked_pose_sensor.h"
#include "session/pose_sensor_conformance.h"

using namespace lodestone;

TEST_CASE("the simulated sensor keeps the contract of a pose sensor") {
  tests::ManualClock clock;
  geometry::Pose2 truth{0.01, -0.02, 3.0};
  session::SensorErrorConfig config;
  config.dropout = 0.3;
  session::SimulatedDetector detector([&] { return truth; }, clock, config, {},
                                      common::RandomStream(3, "noise"));
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  tests::check_pose_sensor(sensor, clock);
}

TEST_CASE("the simulated sensor has the localiser's RMS error") {
  tests::ManualClock clock;
  geometry::Pose2 truth{0.01, -0.02, 3.13};
  session::SensorErrorConfig config;
  config.position_rms_m = 0.00061;
  config.heading_rms_deg = 0.81;
  config.dropout = 0.0;
  session::SimulatedDetector detector([&] { return truth; }, clock, config, {},
                                      common::RandomStream(3, "noise"));
  double square_m2 = 0.0;
  double square_rad2 = 0.0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    truth.x_m = i % 2 == 0 ? 0.01 : 0.012;  // every image is of another place
    const geometry::Pose2 seen = detector.look().candidates.front().pose;
    square_m2 += (seen.position_m() - truth.position_m()).squaredNorm();
    square_rad2 += std::pow(geometry::wrap_angle(seen.heading_rad - truth.heading_rad), 2);
  }
  CHECK(1e3 * std::sqrt(square_m2 / kCount) == Approx(0.61).epsilon(0.02));
  CHECK(std::sqrt(square_rad2 / kCount) * 180.0 / geometry::kPi == Approx(0.81).epsilon(0.02));
}

TEST_CASE("a calibration error moves, scales and turns the image") {
  session::CalibrationError error;
  error.offset_m = {0.001, -0.002};
  error.scale = 1.01;
  error.rotation_rad = geometry::kPi / 2.0;
  const auto seen = error.apply({0.01, 0.02, 3.0});
  CHECK(seen.x_m == Approx(0.001 - 1.01 * 0.02));
  CHECK(seen.y_m == Approx(-0.002 + 1.01 * 0.01));
  CHECK(seen.heading_rad == Approx(3.0 + geometry::kPi / 2.0 - 2.0 * geometry::kPi));
  const auto first = session::draw_calibration_error({}, 5);
  const auto again = session::draw_calibration_error({}, 5);
  const auto other = session::draw_calibration_error({}, 6);
  CHECK(first.offset_m == again.offset_m);
  CHECK(first.rotation_rad == again.rotation_rad);
  CHECK(first.offset_m != other.offset_m);
}

TEST_CASE("the error stays while the needle lies still") {
  tests::ManualClock clock;
  geometry::Pose2 truth{0.01, -0.02, 0.5};
  session::SensorErrorConfig config;
  config.dropout = 0.0;
  config.position_rms_m = 1e-3;
  config.repeatability_m = 1e-5;
  session::SimulatedDetector detector([&] { return truth; }, clock, config, {},
                                      common::RandomStream(3, "noise"));
  const auto look_m = [&] { return detector.look().candidates.front().pose.position_m(); };
  const geometry::Vector2 first_m = look_m();
  for (int i = 0; i < 20; ++i) CHECK((look_m() - first_m).norm() < 1e-4);
  truth.x_m += 0.005;
  const geometry::Vector2 shift_m = look_m() - first_m;
  CHECK((shift_m - geometry::Vector2(0.005, 0.0)).norm() > 1e-4);
}

TEST_CASE("spoiled images show something else as often as they should, and only then") {
  tests::ManualClock clock;
  const geometry::Pose2 truth{0.01, -0.02, 0.5};
  session::SensorErrorConfig config;
  config.outliers = 0.1;
  config.flips = 0.2;
  config.dropout = 0.0;
  session::SimulatedDetector detector([&] { return truth; }, clock, config, {},
                                      common::RandomStream(3, "noise"));
  int elsewhere = 0, flipped = 0;
  constexpr int kCount = 5000;
  for (int i = 0; i < kCount; ++i) {
    const geometry::Pose2 seen = detector.look().candidates.front().pose;
    const double off_m = (seen.position_m() - truth.position_m()).norm();
    elsewhere += off_m > 1e-3 ? 1 : 0;
    flipped += std::cos(seen.heading_rad - truth.heading_rad) < 0.0 ? 1 : 0;
    CHECK((off_m < 1e-3 || (off_m > 9e-3 && off_m < 61e-3)));
  }
  CHECK(elsewhere == Approx(0.1 * kCount).epsilon(0.15));
  CHECK(flipped == Approx(0.2 * kCount).epsilon(0.15));
}
