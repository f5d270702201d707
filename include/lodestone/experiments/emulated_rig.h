#pragma once

#include <cstdint>
#include <memory>

#include "lodestone/emulation/live_bench.h"
#include "lodestone/rig/rig_config.h"

namespace lodestone::experiments {

/// An emulated bench in real time, and the rig.json under which the program drives it as a real one.
struct EmulatedRig {
  std::unique_ptr<emulation::LiveBench> bench;
  rig::RigConfig description;
};

/// `scene`, drawn from `scene_seed`, is what its camera sees; null: there is no camera. Throws HardwareError
/// as LiveBench does.
EmulatedRig make_emulated_rig(const rig::RigConfig& rig, std::uint64_t seed,
                              const imaging::SceneConfig* scene, std::uint64_t scene_seed);

}  // namespace lodestone::experiments
