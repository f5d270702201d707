#include "lodestone/rig/driver_link.h"

#include <catch2/catch.hpp>
#include <thread>

#include "fake_driver.h"

using namespace lodestone;
using common::Json;

namespace {

struct Linked {
  tests::FakeDriver driver;
  rig::DriverLink link{driver.open(), "camera", Json::object(), 1.0, 0.1};
};

}  // namespace

TEST_CASE("a request is answered, with its bytes, or refused, and the link goes on") {
  Linked linked;
  CHECK(linked.link.name() == "driver fake");
  CHECK_THROWS_AS(linked.link.ask({{"do", "levitate"}}), rig::DriverRefused);
  CHECK_THROWS_WITH(linked.link.ask({{"do", "levitate"}}), "driver fake refuses levitate: unknown request");
  linked.driver.other = [](const Json& request) {
    return rig::DriverReply{{{"bytes", 3}, {"of", request["do"]}}, {1, 2, 3}};
  };
  const rig::DriverReply reply = linked.link.ask({{"do", "image"}});
  CHECK(reply.content["of"] == "image");
  CHECK(reply.bytes == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(linked.link.is_open());
}

TEST_CASE("who does not answer, is gone or speaks something else is given up") {
  Linked linked;
  std::string why;
  SECTION("no answer") {
    linked.driver.hangs = true;
    why = "does not answer in time (asked for ping, 0.1 s)";
  }
  SECTION("gone") {
    linked.driver.dies = true;
    why = "driver has gone: has it ended?";
  }
  SECTION("text where a length belongs") {
    linked.driver.babbles = true;
    why = "sends \"Trac\" where a length belongs: does it print to standard output?";
  }
  SECTION("no object") {
    linked.driver.other = [](const Json&) { return rig::DriverReply{Json(7), {}}; };
    why = "sends 7 where an object belongs";
  }
  SECTION("bytes that cannot be") {
    linked.driver.other = [](const Json&) { return rig::DriverReply{{{"bytes", -1}}, {}}; };
    why = "says that -1 bytes follow";
  }
  CHECK_THROWS_WITH(linked.link.ask({{"do", "ping"}}), Catch::Contains(why));
  CHECK_FALSE(linked.link.is_open());
  CHECK_THROWS_WITH(linked.link.ask({{"do", "ping"}}), Catch::Contains("was given up"));
}

TEST_CASE("a driver of another protocol is refused") {
  tests::FakeDriver driver;
  driver.protocol = 2;
  CHECK_THROWS_WITH(rig::DriverLink(driver.open(), "coils", {{"coils", Json::array()}}, 1.0, 0.1),
                    "driver fake speaks protocol 2, this program 1");
}

TEST_CASE("a stop goes ahead of a request that waits") {
  tests::FakeDriver driver;
  std::atomic<bool> stopped{false};
  driver.other = [&](const Json& request) {
    if (request["do"] == "stop") stopped = true;
    if (request["do"] == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return rig::DriverReply{Json::object(), {}};
  };
  rig::DriverLink link(driver.open(), "sensor", Json::object(), 1.0, 1.0);
  std::thread other([&] { link.ask({{"do", "slow"}}); });
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  link.stop();
  CHECK(stopped);
  other.join();
  link.ask({{"do", "ping"}});  // and answers are still told apart
}

TEST_CASE("after a stop nothing is sent that was meant before it") {
  Linked linked;
  const std::int64_t before = linked.link.stops();
  linked.link.stop();
  CHECK_THROWS_WITH(linked.link.ask_unless_stopped({{"do", "ping"}}, before),
                    "the pulse was given up: another thread has stopped the coils");
  linked.link.ask_unless_stopped({{"do", "ping"}}, linked.link.stops());
}

TEST_CASE("a number of a reply is within its bounds, or named") {
  const rig::DriverReply reply{{{"age_s", 0.5}, {"x_m", "left"}}, {}};
  CHECK(reply.number("age_s", 0.0, 1.0) == 0.5);
  CHECK_THROWS_WITH(reply.number("age_s", 0.0, 0.1),
                    "the driver says age_s = 0.5, a number from 0 to 0.1 belongs there");
  CHECK_THROWS_WITH(reply.number("x_m", 0.0, 1.0), Catch::Contains("x_m = \"left\""));
  CHECK_THROWS_WITH(reply.number("y_m", 0.0, 1.0), Catch::Contains("y_m = null"));
}
