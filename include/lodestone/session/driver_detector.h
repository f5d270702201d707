#pragma once

#include "lodestone/physics/needle.h"
#include "lodestone/rig/driver_config.h"
#include "lodestone/rig/driver_link.h"
#include "lodestone/session/needle_detector.h"

namespace lodestone::session {

/// Sees the needle through a driver outside the program (docs/driver-protocol.md), which says of each pose
/// how old it is.
class DriverDetector final : public NeedleDetector {
 public:
  /// Throws ConfigError for an address that is none, HardwareError where the driver cannot be reached.
  DriverDetector(const rig::DriverConfig& config, const physics::NeedleConfig& needle);
  DriverDetector(const rig::DriverConfig& config, const physics::NeedleConfig& needle,
                 const rig::DriverLink::OpenStream& open);

  vision::Sighting look() override;
  void reset() override {}

 private:
  bool sphere_;
  rig::DriverLink link_;
};

/// What a driver's answer to "pose" says, at a time of our clock; of a sphere no heading is asked for. Throws
/// HardwareError where it is none.
vision::Sighting driver_sighting(const rig::DriverReply& reply, double now_s, bool sphere = false);

}  // namespace lodestone::session
