// Whatever one or two faults do to the firmware, no coil stays on.
#include <catch2/catch.hpp>

#include "bus_rig.h"
#include "faults.h"
#include "soak.h"

using namespace lodestone;

TEST_CASE("no seeded run with one or two faults leaves a coil on", "[soak]") {
  const tests::Soak soak("fault runs of the firmware", 1500, 100000);
  tests::check_fault_runs<tests::BusRig>(soak.count(), soak.seed());
}
