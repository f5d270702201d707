#include "lodestone/rig/coil_measurement.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("a rise of current gives back what made it") {
  rig::CurrentTrace trace;
  const double tau_s = 0.0093;
  const double ramp_s = 0.014;
  for (double t_s = 0.004; t_s < 0.08; t_s += 0.004) {
    // Integrated in small steps rather than by the formula of the fit.
    double current_A = 0.0;
    for (double at_s = 0.0; at_s < t_s - 0.002; at_s += 1e-6)
      current_A += 1e-6 / tau_s * (5.0 * std::min(1.0, at_s / ramp_s) - current_A);
    trace.samples.push_back({t_s, current_A});
  }
  CHECK(rig::fit_rise(trace, ramp_s).time_constant_s == Approx(tau_s).epsilon(0.02));
  trace.samples.resize(3);
  CHECK_THROWS_AS(rig::fit_rise(trace, ramp_s), common::DataError);
}
