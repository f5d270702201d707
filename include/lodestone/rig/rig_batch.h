#pragma once

#include <cstddef>
#include <vector>

#include "lodestone/common/thread_pool.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::rig {

/// Gives every rig its pulse and lets it rest for `rest_s` afterwards, on the pool's threads. Rigs are
/// independent: the result does not depend on the number of threads. Throws LogicFault when the sizes differ,
/// HardwareError when a rig refuses its pulse.
void run_pulses(const std::vector<VirtualRig*>& rigs, const std::vector<CoilPulse>& pulses, double rest_s,
                common::ThreadPool& pool);

}  // namespace lodestone::rig
