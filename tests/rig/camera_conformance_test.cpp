#include "camera_conformance.h"

#include <catch2/catch.hpp>

#include "fake_camera.h"
#include "lodestone/rig/free_running_camera.h"

TEST_CASE("the fake camera keeps the contract of Camera") {
  lodestone::tests::FakeCamera camera;
  lodestone::tests::check_camera(camera);
  camera.silent = true;
  lodestone::tests::check_silent_camera(camera);
}

TEST_CASE("a camera that runs freely keeps the contract of Camera") {
  auto fake = std::make_unique<lodestone::tests::FakeCamera>();
  lodestone::rig::FreeRunningCamera camera(std::move(fake), 0.5, 1e-3);
  lodestone::tests::check_camera(camera);
}
