#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/rig/coils.h"

namespace lodestone::tests {

/// What every implementation of Coils must do. `settle_s`: time after which currents have risen or faded.
inline void check_coils_conformance(rig::Coils& coils, common::Clock& clock, double max_current_A,
                                    double settle_s) {
  const auto wait = [&](double time_s) { clock.sleep_until(clock.now_s() + time_s); };
  const auto all_off = [&] {
    for (const double current : coils.status().current_A) {
      if (!(std::abs(current) < 0.01 * max_current_A)) return false;
    }
    return true;
  };
  const double current = 0.2 * max_current_A;
  // Status near the end of a pulse. Where time is real and the machine is busy, it may have been read after
  // the end; that says nothing, and the pulse is tried again.
  const auto near_its_end = [&](const rig::CoilPulse& pulse,
                                const std::optional<rig::CoilPulse>& before = {}) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      if (before) {
        coils.apply(*before);
        wait(settle_s);
      }
      const double applied_s = clock.now_s();
      coils.apply(pulse);
      wait(0.9 * pulse.duration_s);
      const rig::CoilStatus status = coils.status();
      if (clock.now_s() - applied_s < pulse.duration_s) return status;
    }
    FAIL("the machine is too busy to read a coil's status within a pulse");
    return rig::CoilStatus();
  };

  // Status can be read before anything happened.
  CHECK(all_off());
  CHECK(coils.status().faults.empty());
  for (const double temperature : coils.status().temperature_C) CHECK(std::isfinite(temperature));

  // A pulse reaches its own coil only, and ends by itself.
  for (int coil = 0; coil < 4; ++coil) {
    rig::CoilPulse pulse;
    pulse.current_A[coil] = current;
    pulse.duration_s = settle_s;
    const rig::CoilStatus during = near_its_end(pulse);
    for (int other = 0; other < 4; ++other) {
      CHECK(during.current_A[other] == Approx(other == coil ? current : 0.0).margin(0.05 * current));
    }
    wait(0.1 * settle_s + settle_s);
    CHECK(all_off());
  }

  // A new pulse replaces the one before.
  const rig::CoilStatus replaced = near_its_end({{0.0, 0.0, current, 0.0}, settle_s},
                                                rig::CoilPulse{{current, 0.0, 0.0, 0.0}, 10.0 * settle_s});
  CHECK(std::abs(replaced.current_A[0]) < 0.05 * current);
  CHECK(replaced.current_A[2] == Approx(current).epsilon(0.05));
  wait(1.1 * settle_s);
  CHECK(all_off());

  // stop() switches off at any time, and more than once.
  coils.apply({{0.0, current, 0.0, 0.0}, 10.0 * settle_s});
  wait(settle_s);
  CHECK_FALSE(all_off());
  coils.stop();
  coils.stop();
  wait(settle_s);
  CHECK(all_off());

  // What cannot be done is refused and changes nothing.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, 1.01 * max_current_A, -1.01 * max_current_A}) {
    CHECK_THROWS_AS(coils.apply({{0.0, 0.0, 0.0, bad}, settle_s}), common::HardwareError);
  }
  for (const double bad : {nan, infinity, -0.1}) {
    CHECK_THROWS_AS(coils.apply({{current, 0.0, 0.0, 0.0}, bad}), common::HardwareError);
  }
  wait(0.5 * settle_s);
  CHECK(all_off());

  // The limit itself is allowed.
  coils.apply({{max_current_A, 0.0, 0.0, 0.0}, 0.1 * settle_s});
  wait(0.1 * settle_s + settle_s);
  CHECK(all_off());
}

}  // namespace lodestone::tests
