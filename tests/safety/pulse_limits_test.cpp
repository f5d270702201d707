#include "lodestone/safety/pulse_limits.h"

#include <limits>

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {
struct Limits {
  safety::ThermalModel thermal{physics::RigDescription{}};
  safety::PulseLimits limits{10.0, 200.0, 0.2, {}, thermal};
  rig::CoilPulse cut(rig::CoilPulse pulse) {
    limits.check(pulse, {});
    return pulse;
  }
};
}  // namespace

TEST_CASE("current, power and pulse length are cut to their limits") {
  Limits limits;
  const rig::CoilPulse within{{3.0, 0.0, 0.0, 2.0}, 0.1};
  CHECK(limits.cut(within).current_A == within.current_A);
  CHECK(limits.cut(within).duration_s == 0.1);
  const rig::CoilPulse cut = limits.cut({{25.0, 0.0, 0.0, 1.0}, 1.0});
  CHECK(cut.current_A[0] == 10.0);
  CHECK(cut.current_A[3] == 1.0);
  CHECK(cut.duration_s == 0.2);
  const rig::CoilPulse weaker = limits.cut({{-8.0, 0.0, 0.0, 8.0}, 0.1});
  CHECK(weaker.current_A[3] == -weaker.current_A[0]);
  CHECK(limits.thermal.power_W(0, weaker.current_A[0]) == Approx(100.0));
}

TEST_CASE("numbers that are none and opposite coils together are not trusted") {
  Limits limits;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_THROWS_WITH(limits.cut({{0.0, 0.0, nan, 0.0}, 0.1}), Catch::Contains("current of coil +y"));
  CHECK_THROWS_AS(limits.cut({{0.0, infinity, 0.0, 0.0}, 0.1}), safety::Distrust);
  CHECK_THROWS_WITH(limits.cut({{}, infinity}), Catch::Contains("pulse length"));
  CHECK_THROWS_WITH(limits.cut({{}, -0.1}), Catch::Contains("pulse length"));
  CHECK_THROWS_AS(limits.cut({{}, nan}), safety::Distrust);
  CHECK_THROWS_WITH(limits.cut({{1.0, 2.0, 0.0, 0.0}, 0.1}),
                    Catch::Contains("opposite coils +x and -x driven together (1 A and 2 A)"));
}

TEST_CASE("listed coils have limits of their own, and may be on together unless they say otherwise") {
  physics::RigDescription rig;
  rig.coils.resistance_20C_ohm.assign(5, 1.0);
  for (int i = 0; i < 5; ++i) {
    physics::CoilDescription coil;
    coil.name = "c" + std::to_string(i);
    coil.bipolar = i == 1;
    coil.max_current_A = i == 2 ? 3.0 : 0.0;
    if (i == 3) coil.not_with = {"c4"};
    rig.coils.each.push_back(coil);
  }
  rig.coils.inductance_H.assign(5, 1e-3);
  safety::ThermalModel thermal{rig};
  safety::PulseLimits limits{10.0, 2000.0, 0.2, rig.coils, thermal};
  rig::CoilPulse pulse{{-4.0, -4.0, 5.0, 2.0}, 0.1};
  limits.check(pulse, {});
  CHECK(pulse.current_A == physics::PerCoil{0.0, -4.0, 3.0, 2.0});
  pulse.current_A[4] = 1.0;
  CHECK_THROWS_WITH(limits.check(pulse, {}),
                    Catch::Contains("coils c3 and c4 driven together (2 A and 1 A)"));
  pulse.current_A = {1.0, 0.0, 0.0, 0.0, 0.0, 2.0};
  CHECK_THROWS_WITH(limits.check(pulse, {}), Catch::Contains("2 A for coil 6 of a rig of 5 coils"));
}
