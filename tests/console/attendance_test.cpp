#include "lodestone/console/attendance.h"

#include <catch2/catch.hpp>

using namespace lodestone::console;

TEST_CASE("an attended run ends when its page is silent or hidden, and only then") {
  Attendance attendance;
  CHECK_FALSE(attendance.lapse(0.0));  // nothing is driven
  attendance.beat(10.0, true, true);
  attendance.begin(Driving::kAttended);
  CHECK_FALSE(attendance.lapse(10.29));
  CHECK_THAT(attendance.lapse(10.31).value(), Catch::Contains("silent"));
  attendance.beat(10.35, true, false);  // looks on, while another window has the keys
  CHECK_FALSE(attendance.lapse(10.4));
  attendance.beat(10.4, false, false);
  CHECK_THAT(attendance.lapse(10.4).value(), Catch::Contains("hidden"));
  attendance.handed_over(10.5);
  CHECK_FALSE(attendance.lapse(10.7));
  attendance.end();
  CHECK_FALSE(attendance.lapse(99.0));
}

TEST_CASE("an unattended run needs nobody") {
  Attendance attendance;
  attendance.begin(Driving::kUnattended);
  CHECK_FALSE(attendance.lapse(3600.0));
}

TEST_CASE("a hand has to be felt all the time, in a page that has the focus") {
  Attendance attendance;
  attendance.beat(0.0, true, true);
  attendance.begin(Driving::kByHand);
  CHECK_THAT(attendance.lapse(0.0).value(), Catch::Contains("hand"));  // not held yet
  attendance.held(0.0);
  CHECK_FALSE(attendance.lapse(0.2));
  attendance.beat(0.25, true, true);
  CHECK_THAT(attendance.lapse(0.35).value(), Catch::Contains("hand"));
  attendance.held(0.35);
  CHECK_FALSE(attendance.lapse(0.4));
  attendance.beat(0.4, true, false);
  CHECK_THAT(attendance.lapse(0.4).value(), Catch::Contains("focus"));
}
