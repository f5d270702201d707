#pragma once

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/rig/camera.h"

namespace lodestone::tests {

/// What every Camera must keep: colour images of one size whose time goes forward.
inline void check_camera(rig::Camera& camera) {
  const imaging::Frame first = camera.grab(1.0);
  const imaging::Frame second = camera.grab(1.0);
  CHECK(first.image.type() == CV_8UC3);
  CHECK_FALSE(first.image.empty());
  CHECK(second.image.size() == first.image.size());
  CHECK(second.stamp_s > first.stamp_s);
  CHECK(first.image.data != second.image.data);  // a frame kept is not overwritten by the next
}

/// A camera that has stopped answering says so instead of handing out an old image.
inline void check_silent_camera(rig::Camera& camera) {
  CHECK_THROWS_AS(camera.grab(0.01), common::HardwareError);
}

}  // namespace lodestone::tests
