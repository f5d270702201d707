#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lodestone::rig {

/// A byte stream to a device. Every call ends within its timeout.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  /// Waits for at least one byte. Returns how many came, 0 at the timeout. Throws HardwareError when the port
  /// is gone.
  virtual std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) = 0;
  /// Throws HardwareError when the port is gone or does not take the bytes in time.
  virtual void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) = 0;
  /// Throws away what has arrived.
  virtual void discard_input() = 0;
  /// File descriptor that a signal handler may write to; -1 where there is none.
  virtual int descriptor() const noexcept { return -1; }
};

/// Opens a port such as /dev/ttyACM0 for exclusive use, 8N1, without flow control; or an emulated bench's
/// pseudo-terminal, /dev/pts/N. Throws HardwareError that
/// says whether it is missing, busy or forbidden, and which ports there are.
std::unique_ptr<SerialPort> open_serial_port(const std::string& name, int baud);

struct SerialPortInfo {
  std::string name;         ///< /dev/ttyACM0
  std::string description;  ///< as the device tells
};
std::vector<SerialPortInfo> list_serial_ports();

}  // namespace lodestone::rig
