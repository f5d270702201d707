#include "lodestone/experiments/emulated_rig.h"

#include <catch2/catch.hpp>

#include "lodestone/rig/serial_coils.h"

using namespace lodestone;

TEST_CASE("an emulated rig is driven by its own description, as a real one", "[clock]") {
  const experiments::EmulatedRig emulated = experiments::make_emulated_rig({}, 1, nullptr, 1);
  CHECK(emulated.description.real());
  CHECK(emulated.description.camera.kind == rig::RigConfig().camera.kind);
  rig::SerialCoils coils(emulated.description.serial, emulated.description.coils);
  coils.ping();
  CHECK(coils.state().faults.empty());
}
