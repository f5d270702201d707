#include "lodestone/experiments/suture.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "experiments/oblique.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/experiments/deployment.h"

using namespace lodestone;
using experiments::DeploymentConfig;
using experiments::stitches_of;
using tests::oblique;

namespace {

/// One stitch that is listed.
DeploymentConfig one_stitch(const experiments::StitchConfig& stitch) {
  DeploymentConfig config;
  config.trials.suture.stitches = {stitch};
  config.suture.approach_m = config.suture.leave_m = 0.003;
  return config;
}

experiments::SutureConfig read_suture(const char* text) {
  return common::config_from_json<experiments::SutureConfig>(common::Json::parse(text), "suture.json");
}

}  // namespace

TEST_CASE("a suture is a running stitch, or the stitches that are listed") {
  experiments::SutureConfig config;
  CHECK(stitches_of(config).size() == 5);
  CHECK(stitches_of(config).front().entry.x_m == Approx(-0.008));
  config = read_suture(R"({"count": 3, "length_m": 0.008, "pitch_m": 0.005})");
  CHECK(stitches_of(config).size() == 3);
  CHECK(stitches_of(config).front().entry.y_m == Approx(-0.004));
  config = read_suture(R"({"stitches": [
      {"entry_mm": [-8, -3], "entry_deg": 90, "exit_mm": [-7, 3], "exit_deg": 80},
      {"entry_mm": [-4, 3], "entry_deg": 270, "exit_mm": [-4, -3]}]})");
  const auto stitches = stitches_of(config);
  REQUIRE(stitches.size() == 2);
  CHECK(stitches[0].entry.x_m == Approx(-0.008));
  CHECK(stitches[0].exit.y_m == Approx(0.003));
  CHECK(stitches[0].exit.heading_rad == Approx(80.0 * geometry::kRadPerDeg));
  CHECK(stitches[1].entry.heading_rad == Approx(-0.5 * geometry::kPi));
  CHECK(stitches[1].exit.heading_rad == 0.0);
  // As it is written into a run, it reads back.
  const auto again =
      common::config_from_json<experiments::SutureConfig>(common::config_to_json(config), "run");
  CHECK(again.stitches.at(1).entry_mm == config.stitches.at(1).entry_mm);
}

TEST_CASE("what is wrong in a list of stitches is said with the stitch and the key") {
  const char* const bad[][2] = {
      {R"({"stitches": [{"exit_mm": [0, 3]}]})", "stitches[0].entry_mm = [] must hold two numbers"},
      {R"({"stitches": [{"entry_mm": [0, 3], "exit_mm": [0, 3, 4]}]})", "stitches[0].exit_mm"},
      {R"({"stitches": [{"entry_mm": [0, 3], "exit_mm": [0, 3]}, {"entry_mm": 3}]})",
       "stitches[1].entry_mm = 3"},
      {R"({"stitches": [{"entry_mm": [0, 3], "exit_mm": [0, 3], "exit_rad": 1}]})", "exit_rad"},
      {R"({"stitches": [{"entry_mm": [0, 3], "exit_mm": [0, 3], "exit_deg": 400}]})",
       "stitches[0].exit_deg = 400"},
      {R"({"stitches": 5})", "stitches = 5 must be a list of objects"},
      {R"({"count": 0})", "count = 0"}};
  for (const auto& [text, message] : bad) {
    CAPTURE(text);
    CHECK_THROWS_WITH(read_suture(text), Catch::Contains("suture.json") && Catch::Contains(message));
    CHECK_THROWS_AS(read_suture(text), common::ConfigError);
  }
}

TEST_CASE("a needle has arrived where it is held near a target") {
  DeploymentConfig config;
  config.suture.arrive_m = 0.0008;
  config.suture.arrive_deg = 6.0;
  CHECK(experiments::suture_reference(config).arrive_m == 0.0008);
  CHECK(experiments::suture_reference(config).arrive_deg == 6.0);
  config.decorators.hold_radius_m = 0.001;
  config.decorators.hold_heading_deg = 8.0;
  CHECK(experiments::suture_reference(config).arrive_m == 0.001);
  CHECK(experiments::suture_reference(config).arrive_deg == 8.0);
  config.turn.current_A = 1.5;
  config.turn.leave_m = 0.0028;
  config.turn.heading_deg = 7.0;
  CHECK(experiments::suture_reference(config).arrive_m == 0.0028);
  CHECK(experiments::suture_reference(config).arrive_deg == 8.0);
}

TEST_CASE("stitches that no needle can be led through are refused") {
  CHECK_NOTHROW(experiments::check_stitches({}));
  CHECK_NOTHROW(experiments::check_stitches(one_stitch({{-8.0, -3.0}, 60.0, {-2.0, 3.0}, 30.0})));
  DeploymentConfig shorter;
  shorter.trials.suture.length_m = 0.0015;
  CHECK_THROWS_WITH(experiments::check_stitches(shorter),
                    Catch::Contains("stitch 1: entry and exit are 1.5 mm apart, must be more than 2.0 mm"));
  CHECK_THROWS_WITH(
      experiments::check_stitches(one_stitch({{0.0, -3.0}, 90.0, {0.0, 3.0}, -90.0})),
      Catch::Contains(
          "trials.suture.stitches: stitch 1: the heading of its exit is 180 degrees off the way"));
  CHECK_THROWS_WITH(experiments::check_stitches(one_stitch({{0.0, -3.0}, 185.0, {0.0, 3.0}, 90.0})),
                    Catch::Contains("its entry is 95 degrees off"));
  CHECK_NOTHROW(experiments::check_stitches(one_stitch({{-3.0, 0.0}, 90.0, {3.0, 0.0}, -90.0})));
  CHECK_THROWS_WITH(experiments::check_stitches(one_stitch({{0.0, 24.0}, 90.0, {0.0, 30.0}, 90.0})),
                    Catch::Contains("beyond the wall of the dish") && Catch::Contains("at 90 degrees"));
  CHECK_NOTHROW(experiments::check_stitches(one_stitch({{-3.0, 30.0}, 0.0, {3.0, 30.0}, 0.0})));
}

TEST_CASE("stitches, and the ways between them, keep clear of zones") {
  DeploymentConfig config;
  config.safety.keep_out = {{"vessel", {0.008, 0.0}, 0.0005}};
  CHECK_THROWS_WITH(experiments::check_stitches(config),
                    Catch::Contains("trials.suture: stitch 5 would have") && Catch::Contains("vessel"));
  config.safety.keep_out = {{"vessel", {0.0, 0.025}, 0.001}};
  CHECK_NOTHROW(experiments::check_stitches(config));
  config.trials.suture.count = 2;
  config.trials.suture.pitch_m = 0.01;
  CHECK_NOTHROW(experiments::check_stitches(config));
  config.safety.keep_out = {{"vessel", {0.0, 0.006}, 0.0005}};  // on the way from the first to the second
  CHECK_THROWS_WITH(experiments::check_stitches(config), Catch::Contains("stitch 2 would have"));
}

TEST_CASE("a controller that drifts aside in its rehearsals aims beside the ends") {
  DeploymentConfig config;
  const auto stitches = stitches_of(config.trials.suture);
  const auto aims = experiments::aims_of(config, oblique(), stitches);
  REQUIRE(aims.size() == stitches.size());
  for (std::size_t i = 0; i < aims.size(); ++i) {  // 0.6 mm to the left on 6: up is to the left of down
    const double left = i % 2 == 0 ? -1.0 : 1.0;
    CHECK(aims[i].entry.x_m - stitches[i].entry.x_m == Approx(-0.0003 * left).margin(1e-6));
    CHECK(aims[i].exit.x_m - stitches[i].exit.x_m == Approx(0.0003 * left).margin(1e-6));
  }
}

TEST_CASE("without a simulator, without rehearsals or without room stitches are aimed at as they are") {
  const auto stays = [](const DeploymentConfig& config, const experiments::ControllerSource& source) {
    const auto stitches = stitches_of(config.trials.suture);
    const auto aims = experiments::aims_of(config, source, stitches);
    return aims.size() == stitches.size() &&
           std::equal(aims.begin(), aims.end(), stitches.begin(), [](const auto& a, const auto& b) {
             return a.entry.x_m == b.entry.x_m && a.exit.x_m == b.exit.x_m;
           });
  };
  DeploymentConfig config;
  CHECK_FALSE(stays(config, oblique()));
  experiments::ControllerSource blind = oblique();
  blind.rehearses_in = nullptr;
  CHECK(stays(config, blind));
  config.suture.rehearsals = 0;
  CHECK(stays(config, oblique()));
  // A wall to the left leaves 0.1 mm beside the straight way, and not the 0.3 mm of the drift.
  config = {};
  config.trials.suture.count = 1;
  const geometry::KeepOut room = config.safety.keeps_out(config.rig);
  const double wall_m = -(0.001 + 0.5 * room.needle_diameter_m + room.margin_m + 0.0001);
  config.safety.keep_out = {{"wall", {wall_m, -0.02, wall_m, 0.02}, 0.001}};
  CHECK_NOTHROW(experiments::check_stitches(config));
  CHECK(stays(config, oblique()));
}
