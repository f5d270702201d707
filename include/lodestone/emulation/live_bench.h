#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "lodestone/emulation/emulated_bench.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::emulation {

/// An emulated bench in real time, as other programs see a bench: its serial line is a pseudo-terminal, its
/// camera a GigE Vision camera on the loopback (where Aravis is built in). Safe to call from any thread.
class LiveBench {
 public:
  /// `renderer` paints what the camera sees; without one there is no camera. Throws HardwareError when there
  /// is no emulator, no pseudo-terminal or no free camera port (UDP 3956).
  LiveBench(const rig::VirtualRigConfig& rig, std::uint64_t seed,
            std::shared_ptr<const imaging::SceneRenderer> renderer = nullptr);
  ~LiveBench();
  LiveBench(const LiveBench&) = delete;
  LiveBench& operator=(const LiveBench&) = delete;

  /// For rig.serial.port.
  const std::string& port() const;
  /// For rig.camera.source; empty without a camera.
  const std::string& camera() const;
  /// For rig.camera.serial; empty without a camera.
  const std::string& camera_serial() const;

  geometry::Pose2 true_pose();
  void place(const geometry::Pose2& pose);
  /// Runs `action` between two steps: to put in a fault, or to look.
  void with(const std::function<void(EmulatedBench& bench)>& action);
  /// Simulated seconds that could not keep up with real time, in all: a machine too slow or too busy.
  double lost_s();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::emulation
