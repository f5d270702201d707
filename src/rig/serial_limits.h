#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coils/protocol.h"
#include "lodestone/rig/serial_coils.h"

namespace lodestone::rig {

/// Temperature that the description's resistances are of.
constexpr double kResistance_C = 20.0;

/// What the coil controller has to watch, in its units.
wire::CoilLimits wire_limits(const SerialConfig& config, const physics::CoilsDescription& coils);

/// Whether a coil takes less than the largest current, or one sign only, or is kept apart from more than one
/// other: what `wire_limits` cannot say, and has to be said by `wire_ranges`.
bool need_ranges(const physics::CoilsDescription& coils);
wire::CoilRanges wire_ranges(const SerialConfig& config, const physics::CoilsDescription& coils);

/// A pulse in the controller's units and as the coils are wired. Throws HardwareError, naming coil and bound,
/// when it is beyond a limit.
wire::PulseRequest wire_pulse(const SerialConfig& config, const physics::CoilsDescription& coils,
                              const CoilPulse& pulse);

/// A STATUS reply of a bench of so many motor controllers. Throws HardwareError when it has the wrong size.
wire::CoilState coil_state(const std::vector<std::uint8_t>& body, std::uint8_t controllers);

/// What the bits of the controller's latched faults mean.
std::vector<std::string> fault_texts(unsigned bits);

}  // namespace lodestone::rig
