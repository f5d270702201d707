#pragma once

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/clock.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::tests {

/// What every PoseSensor must keep: finite poses with stamps that never go back, and a reason where there is
/// none.
inline void check_pose_sensor(control::PoseSensor& sensor, common::Clock& clock) {
  double last_s = -1e9;
  for (int i = 0; i < 100; ++i) {
    const control::PoseEstimate estimate = sensor.observe();
    CHECK(estimate.stamp_s >= last_s);
    CHECK(estimate.stamp_s <= clock.now_s());
    last_s = estimate.stamp_s;
    if (estimate.valid) {
      CHECK(std::isfinite(estimate.pose.x_m));
      CHECK(std::isfinite(estimate.pose.y_m));
      CHECK(std::abs(estimate.pose.heading_rad) <= geometry::kPi);
      CHECK(estimate.position_sigma_m >= 0.0);
      CHECK(estimate.heading_sigma_rad >= 0.0);
      CHECK(estimate.reason.empty());
    } else {
      CHECK_FALSE(estimate.reason.empty());
    }
    clock.sleep_until(clock.now_s() + 0.3);
  }
}

}  // namespace lodestone::tests
