#pragma once

#include <memory>
#include <string>

#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

/// The stream to a driver: "process:COMMAND" is run by the shell, with its standard input and output as the
/// stream's other end, and ended with the stream (it is given half a second to end by itself);
/// "tcp://HOST:PORT" is connected to. Throws ConfigError for another address, which `key` holds, and
/// HardwareError where nobody can be reached.
std::unique_ptr<SerialPort> open_driver_stream(const std::string& address, double timeout_s,
                                               const std::string& key);

}  // namespace lodestone::rig
