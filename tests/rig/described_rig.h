#pragma once

#include "lodestone/rig/virtual_rig.h"

namespace lodestone::tests {

/// The rig exactly as it is described.
inline rig::VirtualRigConfig described_rig() {
  rig::VirtualRigConfig config;
  config.simulation.deviation = rig::DeviationWidth::kNone;
  return config;
}

}  // namespace lodestone::tests
