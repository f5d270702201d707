#include "lodestone/safety/temperature_check.h"

#include <limits>

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {
struct Coils {
  safety::ThermalModel thermal{physics::RigDescription{}};
  safety::TemperatureCheck check;
  safety::PulseContext context;
  rig::CoilPulse pulse{{5.0, 0.0, 0.0, 0.0}, 0.1};

  explicit Coils(double max_C = 90.0) : check(max_C, 30.0, {}, thermal) {
    context.status.temperature_C.assign(4, 22.0);
  }
  void step() {
    check.check(pulse, context);
    context.last = pulse;
  }
};
}  // namespace

TEST_CASE("a device that says nothing of a coil's temperature is not trusted") {
  Coils coils;
  coils.context.status.temperature_C = physics::PerCoil{22.0, 22.0, 22.0};
  CHECK_THROWS_WITH(coils.step(), Catch::Contains("temperatures of 3 coils, the rig has 4"));
  coils.context.status.temperature_C = {};  // one without thermometers is
  CHECK_NOTHROW(coils.step());
}

TEST_CASE("a coil that is too hot, or whose temperature is unknown, is not trusted") {
  Coils coils;
  coils.step();
  coils.context.status.temperature_C[1] = 95.0;
  CHECK_THROWS_WITH(coils.step(), Catch::Contains("coil -x is at 95 C, limit is 90 C"));
  coils.context.status.temperature_C[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(coils.step(), safety::Distrust);
}

TEST_CASE("a pulse that would overheat a coil is not trusted") {
  Coils coils(22.03);
  coils.pulse.current_A[0] = 5.0;
  coils.step();
  coils.pulse.current_A[0] = 12.0;
  CHECK_THROWS_WITH(coils.step(), Catch::Contains("would heat coil +x"));
}

TEST_CASE("what is measured first is believed, later it must be what the pulses explain") {
  Coils coils;
  coils.context.status.temperature_C[0] = 70.0;
  coils.step();  // nothing has been driven yet: it tells nothing
  coils.step();
  CHECK(coils.thermal.temperature_C(0) == 70.0);
  coils.step();
  coils.context.status.temperature_C[0] = 20.0;
  CHECK_THROWS_WITH(coils.step(), Catch::Contains("measures 20 C where its pulses explain 70 C"));
}
