#include "lodestone/safety/device_check.h"

namespace lodestone::safety {

void DeviceCheck::check(rig::CoilPulse&, const PulseContext& context) {
  if (!context.status.faults.empty()) throw Distrust("the coils report: " + context.status.faults.front());
}

}  // namespace lodestone::safety
