#include "lodestone/physics/measured_region.h"

#include <catch2/catch.hpp>
#include <limits>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

physics::MeasuredRegion sampled() {
  physics::MeasuredRegion region;
  region.centre_m = {0.0, 0.0, 0.01};
  region.scale_m = 0.02;
  region.low_m = {-0.01, -0.02, 0.0};
  region.high_m = {0.01, 0.02, 0.02};
  region.background_T = {1e-3, 0.0, 0.0};
  return region;
}

}  // namespace

TEST_CASE("harmonics of degree 1 are a uniform field, those of degree 2 one that grows with the distance") {
  const physics::MeasuredRegion region = sampled();
  CHECK(region.sum(region.background_T, {0.01, 0.0, 0.0}).isApprox(Eigen::Vector3d(0.0, 0.0, 1e-3)));
  CHECK(region.sum({}, {0.01, 0.0, 0.0}).isZero(0.0));
  std::vector<double> second(8, 0.0);
  second[3] = 1.0;
  const Eigen::Vector3d near = region.sum(second, {0.002, 0.001, 0.011});
  CHECK(near.norm() > 0.0);
  CHECK(region.sum(second, {0.004, 0.002, 0.012}).isApprox(2.0 * near));  // twice as far from the centre
  CHECK_THROWS_AS(region.sum({1.0, 2.0}, {0.0, 0.0, 0.01}), common::LogicFault);
  CHECK((physics::are_harmonics(3) && physics::are_harmonics(48)));
  CHECK_FALSE((physics::are_harmonics(0) || physics::are_harmonics(4)));
}

TEST_CASE("outside of what was measured, nothing is said") {
  const physics::MeasuredRegion region = sampled();
  CHECK_NOTHROW(region.check_holds({0.01, -0.02, 0.02}));
  CHECK_THROWS_WITH(region.check_holds({0.0, 0.0, -0.001}),
                    Catch::Contains("(0.0, 0.0, -1.0) mm is not known: z was measured from 0.0 to 20.0 mm"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(region.check_holds({nan, 0.0, 0.01}), common::DataError);
}

TEST_CASE("the disc of the needle's plane that lies in the box") {
  physics::MeasuredRegion region = sampled();
  CHECK(region.disc_radius_m() == 0.01);
  region.low_m[0] = -0.03;
  region.high_m[0] = 0.03;
  CHECK(region.disc_radius_m() == 0.02);
  region.low_m[2] = 1e-3;  // above the plane
  CHECK(region.disc_radius_m() == 0.0);
  CHECK(physics::MeasuredRegion{}.disc_radius_m() == 0.0);
}

TEST_CASE("what is no box, and no expansion, is refused") {
  CHECK_NOTHROW(physics::MeasuredRegion{}.validate());
  const common::Json whole = common::config_to_json(sampled());
  CHECK(common::config_from_json<physics::MeasuredRegion>(whole, "rig.json") == sampled());
  const auto refused = [&](const char* key, const common::Json& value, const std::string& what) {
    common::Json json = whole;
    json[key] = value;
    CHECK_THROWS_WITH(common::config_from_json<physics::MeasuredRegion>(json, "rig.json"),
                      Catch::Contains("rig.json") && Catch::Contains(what));
  };
  refused("centre_m", {0.0, 0.0}, "centre_m = [0.0,0.0] must hold [x, y, z]");
  refused("centre_m", common::Json::array(), "low_m");
  refused("high_m", {0.01, 0.02, 0.0}, "low_m");
  refused("background_T", {1.0, 2.0}, "background_T = 2 must be 3, 8, 15");
  refused("scale_m", 0.0, "scale_m");
}
