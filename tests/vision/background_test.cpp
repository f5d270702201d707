#include "lodestone/vision/background.h"

#include <catch2/catch.hpp>

#include "lodestone/geometry/angle.h"

using namespace lodestone;
using vision::Background;
using vision::Rod;

namespace {

Rod rod(double x_m, double y_m, double heading_rad) {
  Rod rod;
  rod.pose = {x_m, y_m, heading_rad};
  return rod;
}

}  // namespace

TEST_CASE("what lies where it lay before a pulse is background, whichever end looks like a head") {
  Background background;
  const Rod scratch = rod(0.01, 0.0, 0.3);
  for (int look = 0; look < 3; ++look) background.see({scratch});
  CHECK_FALSE(background.holds(scratch));  // nothing should have moved it
  background.pulse();
  CHECK_FALSE(background.holds(scratch));  // nobody has looked
  background.see({rod(0.0103, 0.0, 0.35 - geometry::kPi)});
  CHECK(background.holds(scratch));
  CHECK_FALSE(background.holds(rod(0.013, 0.0, 0.3)));
  CHECK_FALSE(background.holds(rod(0.01, 0.0, 0.6)));
  background.pulse();
  background.see({});  // something hides it
  CHECK(background.holds(scratch));
  background.forget();
  CHECK_FALSE(background.holds(scratch));
}

TEST_CASE("a needle that stuck is background until it stirs, or is known to be the needle") {
  Background background;
  const Rod stuck = rod(0.01, 0.0, 0.3);
  background.see({stuck});
  background.pulse();
  background.see({stuck});
  REQUIRE(background.holds(stuck));
  SECTION("it turns") {
    background.pulse();
    const Rod turned = rod(0.0105, 0.0, 0.9);
    background.see({turned});
    CHECK_FALSE(background.holds(turned));
    CHECK(background.has_stirred(turned));
  }
  SECTION("it is seen to be the needle by other means") {
    background.except(stuck);
    background.see({stuck});
    CHECK_FALSE(background.holds(stuck));
  }
}

TEST_CASE("what turns a little further with every pulse is none of it") {
  Background background;
  for (int pulse = 0; pulse < 4; ++pulse) {
    background.see({rod(0.0, 0.0, 0.2 * pulse)});
    background.pulse();
  }
  for (int pulse = 0; pulse < 4; ++pulse) CHECK_FALSE(background.holds(rod(0.0, 0.0, 0.2 * pulse)));
  CHECK(background.has_stirred(rod(0.0, 0.0, 0.8)));
}

TEST_CASE("what has only come into view has not stirred") {
  Background background;
  background.see({rod(0.0, 0.0, 0.3)});
  CHECK_FALSE(background.has_stirred(rod(0.0, 0.0, 0.9)));  // without a pulse
  background.pulse();
  CHECK(background.has_stirred(rod(0.0, 0.0, 0.9)));
  CHECK_FALSE(background.has_stirred(rod(0.0, 0.0, 0.3)));
  CHECK_FALSE(background.has_stirred(rod(0.03, 0.0, 0.9)));  // nothing lay there
}
