#include "lodestone/session/sensing.h"

#include <catch2/catch.hpp>

using namespace lodestone;
using session::Sensing;
using session::SensingConfig;

namespace {

SensingConfig simulated() {
  SensingConfig config;
  config.kind = "simulated";
  return config;
}

}  // namespace

TEST_CASE("a simulated sensor sees the needle near to where it lies, and goes on bitwise after a restore") {
  rig::VirtualRig rig({}, 1);
  rig.place({0.01, -0.005, 1.0});
  const Sensing sensing(simulated(), {});
  const auto sensor = sensing.make(rig, sensing.new_bench(4), common::RandomStream(1, "noise"));
  CHECK(sensor->camera() == nullptr);
  CHECK(sensor->watched() == nullptr);
  const control::PoseEstimate seen = sensor->observe();
  CHECK(seen.valid);
  CHECK(seen.pose.x_m == Approx(0.01).margin(1e-3));
  const std::string state = sensor->save();
  sensor->forget();
  const double first_m = sensor->observe().pose.x_m;
  sensor->restore(state);
  CHECK(sensor->observe().pose.x_m == first_m);
}

TEST_CASE("a bench is seen the same under one seed, and otherwise under another") {
  rig::VirtualRig rig({}, 1);
  rig.place({0.01, -0.005, 1.0});
  auto config = simulated();
  config.simulated.calibration_offset_m = 1e-3;
  const Sensing sensing(config, {});
  const auto seen_m = [&](std::uint64_t seed) {
    return sensing.make(rig, sensing.calibrated_bench(seed), common::RandomStream(1, "noise"))
        ->observe()
        .pose.x_m;
  };
  CHECK(seen_m(4) == seen_m(4));
  CHECK(seen_m(4) != seen_m(5));
}

TEST_CASE("the scene is of the rig's own size") {
  rig::VirtualRigConfig large;
  large.dish.radius_m = 0.05;
  large.simulation.obstacles.emplace_back();
  CHECK(Sensing(simulated(), large).bench().dish_radius_m == 0.05);
  CHECK(Sensing(simulated(), large).bench().obstacles_m.empty());  // of which no description tells
}

TEST_CASE("the camera sees obstacles of a trial beside those of the rig") {
  rig::VirtualRigConfig rig;
  rig.simulation.obstacles.emplace_back();
  SensingConfig config;
  config.segmenter = std::string(LODESTONE_SOURCE_DIR) + "/models/segmenter";
  const Sensing sensing(config, rig);
  physics::ObstacleConfig more;
  more.centre_m = {0.02, 0.0};
  CHECK(sensing.new_bench(3).renderer->scene().bench.obstacles_m.size() == 1);
  CHECK(sensing.new_bench(3, {more}).renderer->scene().bench.obstacles_m.size() == 2);
}
