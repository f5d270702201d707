// Whatever one or two faults do to the firmware, no coil stays on.
#include <catch2/catch.hpp>

#include "bus_rig.h"
#include "faults.h"
#include "soak.h"

using namespace lodestone;

namespace {

struct BusRigOfEight : tests::BusRig {
  BusRigOfEight() : BusRig(8) {}
};

}  // namespace

TEST_CASE("no seeded run with one or two faults leaves a coil on", "[soak]") {
  const tests::Soak soak("fault runs of the firmware", 1500, 100000);
  tests::check_fault_runs<tests::BusRig>(soak.count(), soak.seed());
}

TEST_CASE("no seeded run with one or two faults leaves one of sixteen coils on", "[soak]") {
  const tests::Soak soak("fault runs of the firmware for eight motor controllers", 300, 20000);
  tests::check_fault_runs<BusRigOfEight>(soak.count(), soak.seed());
}
