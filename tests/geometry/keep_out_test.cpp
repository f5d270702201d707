#include "lodestone/geometry/keep_out.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using geometry::KeepOut;

TEST_CASE("a needle's clearance is that of its nearest end or side, as it lies") {
  KeepOut keep_out{{{"disc", {0.02, 0.0}, 0.004}}, 0.02, 0.001, 0.002};
  CHECK(keep_out.clearance_m({0.0, 0.0, 0.0}) == Approx(0.0055));  // its head
  CHECK(keep_out.clearance_m({0.0, 0.0, 3.0}) ==
        Approx(keep_out.clearance_m({0.0, 0.0, 3.0 - geometry::kPi})));
  CHECK(keep_out.clearance_m({0.0, 0.0, 0.5 * geometry::kPi}) == Approx(0.0155));  // its side
  CHECK(keep_out.clearance_m({0.01, 0.0, 0.0}) < 0.0);
  CHECK(keep_out.clearance_m({0.0, 0.0}, {0.0, 0.0}) == Approx(0.0155));
  CHECK(keep_out.clearance_m({0.0, 0.0}, {0.015, 0.0}) == Approx(0.0005));
  CHECK(keep_out.any_way_m() == Approx(0.012));
  keep_out.zones.push_back({"wall", {-0.01, -0.01, -0.01, 0.01}, 0.0});
  CHECK(keep_out.clearance_m({0.0, 0.0, 0.5 * geometry::kPi}) == Approx(0.0095));  // the nearer one
}

TEST_CASE("without zones there is room without end") {
  const KeepOut keep_out;
  CHECK(keep_out.empty());
  CHECK(std::isinf(keep_out.clearance_m({0.0, 0.0, 0.0})));
  CHECK(std::isinf(keep_out.clearance_m({0.0, 0.0}, {0.01, 0.0})));
}
