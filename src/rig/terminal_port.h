#pragma once

#include <memory>
#include <string>

#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

/// A pseudo-terminal, which is how an emulated bench shows its serial line; libserialport opens devices only.
/// Throws HardwareError.
std::unique_ptr<SerialPort> open_terminal(const std::string& name);

}  // namespace lodestone::rig
