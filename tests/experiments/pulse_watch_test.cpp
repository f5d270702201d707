#include "lodestone/experiments/pulse_watch.h"

#include <catch2/catch.hpp>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/experiments/emulated_rig.h"
#include "lodestone/rig/serial_coils.h"

using namespace lodestone;

TEST_CASE("pulses are seen where they begin, however they were asked for", "[clock]") {
  std::optional<experiments::EmulatedRig> rig;
  try {
    rig.emplace(experiments::make_emulated_rig(rig::RigConfig{}, 1, nullptr, 1));
  } catch (const common::HardwareError& error) {
    WARN("no emulator: " << error.what());
    return;
  }
  const experiments::PulseWatch watch(*rig->bench);
  rig::SerialCoils coils(rig->description.serial, rig->description.coils);
  common::SteadyClock clock;
  CHECK(watch.pulses() == 0);
  const double start_s = clock.now_s();
  for (int i = 0; i < 3; ++i) {
    coils.apply({{2.0, 0.0, 0.0, 0.0}, 0.1});
    clock.sleep_until(start_s + 0.3 * (i + 1));
  }
  CHECK(watch.pulses() == 3);
  CHECK(watch.last_wall_s() > start_s + 0.5);
  CHECK(watch.deviations_ms(0.3).size() == 2);
  CHECK(watch.deviations_ms(0.3, 1).size() == 1);
}
