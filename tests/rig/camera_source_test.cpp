#include "lodestone/rig/camera_source.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/rig/aravis_camera.h"

using namespace lodestone;
using Catch::Matchers::Contains;

TEST_CASE("camera settings are read strictly") {
  const auto read = [](const char* text) {
    return common::config_from_json<rig::CameraSourceConfig>(common::Json::parse(text), "rig.json");
  };
  CHECK(read(R"({"kind": "uvc", "source": "0"})").width_px == 1280);
  CHECK_THROWS_WITH(read(R"({"kind": "webcam"})"), Contains("kind") && Contains("webcam"));
  CHECK_THROWS_WITH(read(R"({"frame_rate_hz": 0})"), Contains("frame_rate_hz"));
}

TEST_CASE("a build without Aravis names the package") {
  if (rig::AravisCamera::available()) return;
  rig::CameraSourceConfig config;
  config.kind = rig::CameraKind::kGenicam;
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("libaravis-dev"));
}

TEST_CASE("a camera that nobody has named is asked for by its key") {
  CHECK_THROWS_WITH(rig::open_camera({}), Catch::Contains("rig.camera.source is empty"));
}

TEST_CASE("images from disk are the camera where no other kind is named") {
  rig::CameraSourceConfig config;
  config.source = "missing.png";
  CHECK_THROWS_WITH(rig::open_camera(config), Contains("missing.png"));
}
