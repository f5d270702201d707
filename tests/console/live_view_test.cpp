#include "lodestone/console/live_view.h"

#include <catch2/catch.hpp>

#include "paper_rig.h"
#include "sphere_rig.h"

using namespace lodestone;
using console::ImageMap;
using console::LiveView;
using geometry::Vector2;

TEST_CASE("places go into the image and back") {
  const ImageMap map{imaging::CameraModel{}};
  CHECK(map.to_image({0.0, 0.0}).x() == Approx(0.5).margin(1e-6));
  CHECK(map.to_image({0.01, 0.0}).x() > 0.55);  // coil +x is on the right
  CHECK(map.to_image({0.0, 0.01}).y() < 0.45);  // and +y at the top
  const Vector2 back_m = map.to_dish(map.to_image({0.012, -0.007}));
  CHECK((back_m - Vector2(0.012, -0.007)).norm() < 1e-9);
}

TEST_CASE("zones to keep out of are shown side by side") {
  safety::SafetyConfig safety;
  console::BenchState state;
  state.camera = imaging::CameraModel{};
  CHECK_FALSE(LiveView(tests::paper_rig(), safety).json(state).contains("keep_out"));
  state.keep_out.zones = {{"disc", {0.01, 0.0}, 0.004}, {"triangle", {0.0, 0.0, 0.01, 0.0, 0.0, 0.01}, 0.0}};
  const common::Json json = LiveView(tests::paper_rig(), safety).json(state);
  REQUIRE(json["keep_out"].size() == 4);
  const ImageMap map{imaging::CameraModel{}};
  for (const common::Json& place : json["keep_out"][0]) {
    const Vector2 at_m = map.to_dish({place[0].get<double>(), place[1].get<double>()});
    CHECK((at_m - Vector2(0.01, 0.0)).norm() == Approx(0.004).margin(1e-4));
  }
}

TEST_CASE("a bench's state is told as the page has it, and what is not known is null or absent") {
  const LiveView view(tests::paper_rig(), safety::SafetyConfig{});
  console::BenchState state;
  state.mode = console::Mode::kStopped;
  state.reason = "why";
  common::Json json = view.json(state);
  CHECK(json["mode"] == "stopped");
  CHECK(json["reason"] == "why");
  CHECK(json["pose"].is_null());
  CHECK(json["run"].is_null());
  CHECK(json["sample"].is_null());
  CHECK(json["limits"].empty());
  CHECK_FALSE(json.contains("fence"));  // nobody knows where that is in the image

  state.camera = imaging::CameraModel{};
  state.now_s = 10.0;
  control::PoseEstimate seen;
  seen.valid = true;
  seen.pose = {0.01, 0.0, 0.5 * geometry::kPi};
  seen.stamp_s = 9.9;
  seen.position_covariance_m2 = Vector2(1e-8, 4e-8).asDiagonal();
  state.pose = seen;
  state.target_m = Vector2(0.0, 0.0);
  state.target_heading_rad = 0.0;
  state.run = console::BenchRun{"point", 1.0, 3};
  console::BenchSample sample;
  sample.current_A = {0.0, 7.5, 0.0, 0.0};
  sample.temperature_C = {22.0, 22.0, 40.0, 22.0};
  state.sample = sample;
  json = view.json(state);
  CHECK(json["pose"]["age_s"].get<double>() == Approx(0.1));
  CHECK(json["pose"]["heading_deg"].get<double>() == Approx(90.0));
  CHECK(json["pose"]["head"][1] < json["pose"]["tail"][1]);  // towards +y, which is up
  CHECK(json["spread"].size() > 10);
  CHECK(json["target_head"][0] > json["target"][0]);
  CHECK(json["run"]["left_s"].is_null());
  CHECK(json["field"].empty());
  CHECK(json["sample"]["supply_V"].is_null());
  CHECK(json["fence"].size() > 10);
  CHECK(json["coil_places"].size() == 4);
  CHECK(json["axes"][0][0] > 0.0);  // x to the right,
  CHECK(json["axes"][1][1] < 0.0);  // y up
  bool warmest = false;
  for (const common::Json& limit : json["limits"])
    warmest = warmest || (limit["name"] == "coil temperature" && limit["value"] == 40.0);
  CHECK(warmest);

  CHECK_FALSE(json.contains("plan_heads"));
  state.plan_headings.push_back({0.0, 0.01, 0.5 * geometry::kPi});
  json = view.json(state);
  REQUIRE(json["plan_heads"].size() == 1);
  CHECK(json["plan_heads"][0][1][1] < json["plan_heads"][0][0][1]);  // towards +y, which is up

  for (int i = 0; i < 10000; ++i) state.plan_m.emplace_back(1e-6 * i, 0.0);
  json = view.json(state);
  CHECK(json["plan"].size() > 1000);
  CHECK(json["plan"].size() <= 2000);
  CHECK(json["plan"].back()[0].get<double>() ==
        Approx(ImageMap(*state.camera).to_image({0.009999, 0.0}).x()).margin(1e-5));

  state.on_A = {10.0, 0.0, 0.0, 0.0};
  json = view.json(state);
  REQUIRE(json["field"].size() > 20);
  CHECK(json["field"][json["field"].size() / 2][2] > 0.0);  // at the centre, towards the coil that is on

  const LiveView round(tests::sphere_rig(), safety::SafetyConfig{});
  json = round.json(state);
  CHECK(json["pose"].contains("middle"));
  for (const char* of_heading : {"heading_deg", "head", "tail"})
    CHECK_FALSE(json["pose"].contains(of_heading));
}
