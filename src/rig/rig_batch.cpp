#include "lodestone/rig/rig_batch.h"

#include <string>

#include "lodestone/common/error.h"

namespace lodestone::rig {

void run_pulses(const std::vector<VirtualRig*>& rigs, const std::vector<CoilPulse>& pulses, double rest_s,
                common::ThreadPool& pool) {
  LODESTONE_CHECK(rigs.size() == pulses.size(),
                  std::to_string(rigs.size()) + " rigs but " + std::to_string(pulses.size()) + " pulses");
  LODESTONE_CHECK(rest_s >= 0.0, "the rest must not be negative");
  pool.for_each(rigs.size(), [&](std::size_t i) {
    VirtualRig& rig = *rigs[i];
    const double start_s = rig.clock().now_s();
    rig.coils().apply(pulses[i]);
    rig.clock().sleep_until(start_s + pulses[i].duration_s + rest_s);
  });
}

}  // namespace lodestone::rig
