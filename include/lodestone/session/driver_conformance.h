#pragma once

#include <string>
#include <vector>

#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/needle.h"
#include "lodestone/rig/camera_source.h"
#include "lodestone/rig/driver_config.h"
#include "lodestone/rig/driver_link.h"

namespace lodestone::session {

/// One thing that a driver has to do, and what it did.
struct ConformanceItem {
  std::string what;
  bool passed = false;
  std::string seen;
};

/// Opens the stream to a driver anew, as often as it is asked.
using OpenDriver = rig::DriverLink::OpenStream;

/// Whether a driver of coils does what docs/driver-protocol.md asks of it: answers in time, gives each coil
/// its current and no other, refuses what is beyond the limits, and switches off at the end of a pulse, at a
/// stop, in silence and when its program has gone. Gives each coil up to `test_current_A` for some tenths of
/// a second, the first up to a second, where the driver does as it is told; and asks for more than the
/// largest current, and for coils that are never on together, for 20 ms, which has to be refused. What a
/// driver cannot do is an item, not an exception; where it does not answer, or is not off to begin with, the
/// last. Every stream ends with a stop. Throws ConfigError where `open` does, Interrupted at Ctrl-C.
std::vector<ConformanceItem> check_coils_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                const physics::CoilsDescription& coils,
                                                double test_current_A);
/// The same of one that sees the needle, and of one that hands out images.
std::vector<ConformanceItem> check_sensor_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                 const physics::NeedleConfig& needle);
std::vector<ConformanceItem> check_camera_driver(const OpenDriver& open, const rig::DriverConfig& config,
                                                 double timeout_s);

}  // namespace lodestone::session
