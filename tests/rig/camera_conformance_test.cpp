#include "camera_conformance.h"

#include <catch2/catch.hpp>

#include "fake_camera.h"

TEST_CASE("the fake camera keeps the contract of Camera") {
  lodestone::tests::FakeCamera camera;
  lodestone::tests::check_camera(camera);
  camera.silent = true;
  lodestone::tests::check_silent_camera(camera);
}
