#include <cstdio>

#include "lodestone/physics/coil_drive.h"
#include "lodestone/rig/virtual_rig.h"

/// Places the needle at the dish centre and pulls it towards coil +x: exits 0 when it went that way.
int main() {
  lodestone::rig::VirtualRig rig(lodestone::rig::VirtualRigConfig{}, 1);
  rig.place({0.0, 0.0, 0.0});
  lodestone::rig::CoilPulse pulse;
  pulse.current_A = lodestone::physics::opposed_pairs_A({8.0, 0.0});
  pulse.duration_s = 0.1;
  rig.coils().apply(pulse);
  rig.clock().sleep_until(rig.clock().now_s() + 0.3);
  std::printf("moved %.2f mm towards +x\n", 1e3 * rig.true_pose().x_m);
  return rig.true_pose().x_m > 0.001 ? 0 : 1;
}
