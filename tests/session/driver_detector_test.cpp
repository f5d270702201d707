#include "lodestone/session/driver_detector.h"

#include <catch2/catch.hpp>

#include "../rig/fake_driver.h"

using namespace lodestone;
using common::Json;

TEST_CASE("a driver says where the needle is, how sure it is and how old that is", "[clock]") {
  tests::FakeDriver driver;
  Json said = {{"age_s", 0.02},      {"x_m", 0.01},     {"y_m", -0.02},
               {"heading_rad", 7.0}, {"sigma_m", 1e-4}, {"sigma_rad", 0.02}};
  driver.other = [&](const Json& request) {
    return rig::DriverReply{request["do"] == "pose" ? said : Json{{"error", "what?"}}, {}};
  };
  session::DriverDetector detector({}, {}, driver.open());
  const double before_s = common::SteadyClock().now_s();
  const vision::Sighting sighting = detector.look();
  CHECK(sighting.stamp_s >= before_s - 0.02);
  CHECK(sighting.stamp_s <= common::SteadyClock().now_s() - 0.02);
  REQUIRE(sighting.candidates.size() == 1);
  const vision::Rod& rod = sighting.candidates[0];
  CHECK(rod.pose.x_m == 0.01);
  CHECK(rod.pose.heading_rad == Approx(7.0 - 2.0 * 3.14159265358979));
  CHECK(rod.covariance(0, 0) == Approx(1e-8));
  CHECK(rod.head_certainty > 0.999);
  said["head_certainty"] = 0.5;  // a needle without a mark
  CHECK(detector.look().candidates[0].tape_log_odds == Approx(0.0).margin(1e-9));
  said = {{"age_s", 0.02}, {"reason", "too dark"}};
  CHECK(detector.look().candidates.empty());
  CHECK(detector.look().reason == "too dark");
}

TEST_CASE("what is no pose is named", "[clock]") {
  const Json good = {{"age_s", 0.02},      {"x_m", 0.01},     {"y_m", -0.02},
                     {"heading_rad", 0.0}, {"sigma_m", 1e-4}, {"sigma_rad", 0.02}};
  for (const char* key : {"age_s", "y_m", "heading_rad", "sigma_m", "sigma_rad"}) {
    Json bad = good;
    bad[key] = "left";
    CHECK_THROWS_WITH(session::driver_sighting({bad, {}}, 1.0),
                      Catch::Contains(std::string(key) + " = \"left\""));
  }
  Json place = good;
  place.erase("heading_rad");
  place.erase("sigma_rad");
  CHECK_THROWS_AS(session::driver_sighting({place, {}}, 1.0), common::HardwareError);
  const vision::Sighting sphere = session::driver_sighting({place, {}}, 1.0, /*sphere=*/true);
  REQUIRE(sphere.candidates.size() == 1);
  CHECK(sphere.candidates[0].pose.y_m == -0.02);
  CHECK(sphere.candidates[0].pose.heading_rad == 0.0);
  Json no_age = good;
  no_age.erase("age_s");
  CHECK_THROWS_AS(session::driver_sighting({no_age, {}}, 1.0), common::HardwareError);
}
