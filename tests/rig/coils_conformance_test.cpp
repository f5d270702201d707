#include "rig/coils_conformance.h"

#include <catch2/catch.hpp>

#include "lodestone/rig/virtual_rig.h"
#include "rig/fake_coils.h"

namespace lodestone {
namespace {

TEST_CASE("the virtual rig's coils keep the contract of Coils") {
  rig::VirtualRig rig(rig::VirtualRigConfig{}, 1);
  tests::check_coils_conformance(rig.coils(), rig.clock(), rig.config().coils.max_current_A, 0.1);
}

TEST_CASE("the fake coils keep the contract of Coils") {
  tests::FakeRigClock clock;
  tests::FakeCoils coils(clock, 15.0);
  tests::check_coils_conformance(coils, clock, 15.0, 0.1);
  CHECK(coils.pulses.size() == 8);
  CHECK(coils.stops == 2);
}

}  // namespace
}  // namespace lodestone
