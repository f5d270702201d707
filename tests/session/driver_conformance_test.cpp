#include "lodestone/session/driver_conformance.h"

#include <catch2/catch.hpp>
#include <map>

#include "../rig/fake_driver.h"

using namespace lodestone;
using common::Json;

namespace {

/// What failed, and what was seen.
std::map<std::string, std::string> failed(const std::vector<session::ConformanceItem>& items) {
  std::map<std::string, std::string> found;
  for (const session::ConformanceItem& item : items)
    if (!item.passed) {
      found[item.what] = item.seen;
      UNSCOPED_INFO(item.what << ": " << item.seen);
    }
  return found;
}

std::map<std::string, std::string> failed(tests::FakeDriver& driver) {
  return failed(session::check_coils_driver(driver.open(), {}, {}, 3.0));
}

}  // namespace

TEST_CASE("a driver that keeps the protocol passes", "[clock]") {
  tests::FakeDriver driver;
  const auto items = session::check_coils_driver(driver.open(), {}, {}, 3.0);
  CHECK(failed(items).empty());
  CHECK(items.size() == 15);
  CHECK_FALSE(driver.on());
}

TEST_CASE("what a driver does not do is named", "[clock]") {
  tests::FakeDriver driver;
  SECTION("limits are nothing to it") {
    driver.takes_all = true;
    const auto found = failed(driver);
    CHECK(found.count("refuses more current than a coil may have") == 1);
    CHECK(found.count("refuses a pulse that is too long") == 1);
    CHECK(found.count("refuses +x and -x together") == 1);
    CHECK(found.count("refuses what it does not know, and goes on") == 1);
    CHECK(found.size() ==
          7);  // and the other pair, and what it latches in silence, which is then still there
  }
  SECTION("silence is nothing to it") {
    driver.keeps_on = true;
    const auto found = failed(driver);
    CHECK_THAT(found.at("switches off after 0.5 s of silence, and latches it"),
               Catch::Contains("coil +x still has 3.00 A"));
    CHECK(found.count("switches off when its program has gone") == 1);
    CHECK(found.size() == 2);
  }
  SECTION("two coils are swapped") {
    driver.say([last = 0.0](std::size_t coil, double current_A) mutable {
      if (coil == 0) last = current_A;
      return coil == 1 ? last : coil == 0 ? 0.0 : current_A;
    });
    CHECK_THAT(failed(driver).at("coil +x: its current, no other, and an end"),
               Catch::Contains("coil +x has 0.00 A"));
  }
  SECTION("it is never off") {
    driver.say([](std::size_t, double) { return 2.0; });
    CHECK(session::check_coils_driver(driver.open(), {}, {}, 3.0).size() == 2);
    CHECK(driver.pulses() == 0);
  }
  SECTION("it answers nothing") {
    driver.hangs = true;
    rig::DriverConfig config;
    config.start_timeout_s = 0.1;
    CHECK(session::check_coils_driver(driver.open(), config, {}, 3.0).size() == 1);
  }
}

TEST_CASE("drivers that see: rate, age, and time that goes on", "[clock]") {
  tests::FakeDriver driver;
  double age_s = 0.01;
  driver.other = [&](const Json& request) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (request["do"] == "pose") return rig::DriverReply{{{"age_s", age_s}, {"reason", "too dark"}}, {}};
    return rig::DriverReply{
        {{"format", "gray8"}, {"width_px", 16}, {"height_px", 16}, {"age_s", age_s}, {"bytes", 256}},
        std::vector<std::uint8_t>(256)};
  };
  const auto sensor = session::check_sensor_driver(driver.open(), {}, {});
  CHECK(failed(sensor).empty());
  CHECK_THAT(sensor[0].seen, Catch::Contains("seen 0 of 30 times"));
  CHECK(failed(session::check_camera_driver(driver.open(), {}, 0.5)).empty());
  driver.other = [&](const Json&) {
    age_s += 1.0;
    return rig::DriverReply{{{"age_s", age_s}, {"reason", "too dark"}}, {}};
  };
  CHECK_THAT(failed(session::check_sensor_driver(driver.open(), {}, {})).begin()->second,
             Catch::Contains("its time went back"));
}
