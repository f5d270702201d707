#include "current_watch.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using rig::CurrentWatch;

namespace {

const rig::CoilPulse kWatched{{5.0, 0.4, 0.0, 0.0}, 0.1};

/// What is said of currents in the middle of a pulse as short as those of the control loop.
std::string in_the_middle(const physics::PerCoil& measured_A) {
  CurrentWatch watch{physics::CoilsDescription{}};
  watch.pulse(kWatched, 9.995, 10.0);
  return watch.distrust(measured_A, 10.06, 10.07);
}

}  // namespace

TEST_CASE("a current that is about what was asked is trusted, and one that cannot be is named") {
  CHECK(in_the_middle({5.0, 0.4, 0.0, 0.0}) == "");
  CHECK(in_the_middle({4.0, 0.0, -0.1, 0.0}) == "");  // a weak one may be nothing
  CHECK_THAT(in_the_middle({1.0, 0.4, 0.0, 0.0}),
             Catch::Contains("coil +x was asked for 5 A and is said to have 1 A"));
  CHECK_THAT(in_the_middle({-5.0, 0.4, 0.0, 0.0}), Catch::Contains("said to have -5 A"));
  CHECK_THAT(in_the_middle({8.0, 0.4, 0.0, 0.0}), Catch::Contains("asked for 5 A"));
  CHECK_THAT(in_the_middle({5.0, 3.0, 0.0, 0.0}), Catch::Contains("coil -x was asked for 0.4 A"));
  CHECK_THAT(in_the_middle({5.0, 0.4, 2.0, 0.0}), Catch::Contains("coil +y is switched off"));
  CHECK_THAT(in_the_middle({25.0, 0.0, 0.0, 0.0}), Catch::Contains("over-current"));
  CHECK_THAT(in_the_middle({std::nan(""), 0.0, 0.0, 0.0}), Catch::Contains("over-current"));
}

TEST_CASE("currents have their time to rise and to fade, and a device its own idea of when") {
  const physics::PerCoil on = {5.0, 0.4, 0.0, 0.0}, off = {0.0, 0.0, 0.0, 0.0};
  CurrentWatch watch{physics::CoilsDescription{}};
  CHECK(watch.over());
  watch.pulse(kWatched, 9.98, 10.0);
  CHECK_FALSE(watch.over());
  CHECK(watch.look_at_s(10.0) == Approx(10.05));
  CHECK(watch.look_at_s(10.05) == Approx(10.1));
  CHECK(watch.distrust(off, 10.04, 10.045) == "");
  CHECK_THAT(watch.distrust(off, 10.05, 10.06), Catch::Contains("asked for 5 A"));
  CHECK(watch.distrust(off, 10.075, 10.085) == "");  // it may have begun when it was asked
  CHECK(watch.distrust(on, 10.2, 10.21) == "");
  CHECK_FALSE(watch.over());
  CHECK_THAT(watch.distrust(on, 10.26, 10.27), Catch::Contains("coil +x is switched off"));
  CHECK(watch.distrust({0.1, 0.0, 0.0, 0.0}, 10.26, 10.27) == "");
  CHECK(watch.over());
  CHECK_THAT(watch.distrust(on, 20.0, 20.01), Catch::Contains("is switched off"));
}

TEST_CASE("a coil that the next pulse leaves out has to be off, though others are on") {
  CurrentWatch watch{physics::CoilsDescription{}};
  watch.pulse({{5.0, 0.0, 0.0, 0.0}, 1.0}, 10.0, 10.0);
  watch.pulse({{0.0, 0.0, 5.0, 0.0}, 1.0}, 10.3, 10.3);
  CHECK(watch.distrust({5.0, 0.0, 5.0, 0.0}, 10.44, 10.45) == "");
  CHECK_THAT(watch.distrust({5.0, 0.0, 5.0, 0.0}, 10.46, 10.47), Catch::Contains("coil +x is switched off"));
}

TEST_CASE("after a stop the coils are off, however long the pulse was") {
  CurrentWatch watch{physics::CoilsDescription{}};
  watch.pulse({{5.0, 0.0, 0.0, 0.0}, 1.0}, 10.0, 10.0);
  watch.stop(10.3);
  CHECK(watch.distrust({5.0, 0.0, 0.0, 0.0}, 10.29, 10.31) == "");
  CHECK(watch.distrust({0.0, 0.0, 0.0, 0.0}, 10.29, 10.31) == "");
  CHECK_THAT(watch.distrust({5.0, 0.0, 0.0, 0.0}, 10.46, 10.47), Catch::Contains("coil +x is switched off"));
}
