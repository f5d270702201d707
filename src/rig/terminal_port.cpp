#include "terminal_port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "descriptor_port.h"
#include "lodestone/common/error.h"

namespace lodestone::rig {

std::unique_ptr<SerialPort> open_terminal(const std::string& name) {
  const int file = open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0)
    throw common::HardwareError("pseudo-terminal " + name + " cannot be opened: " + std::strerror(errno) +
                                "; is the emulated bench still running?");
  auto port =
      std::make_unique<DescriptorPort>(file, "pseudo-terminal " + name, "has the emulated bench ended?");
  // No TIOCEXCL: it outlives a killed process for as long as the other end is open.
  if (flock(file, LOCK_EX | LOCK_NB) != 0)
    throw common::HardwareError("pseudo-terminal " + name + " cannot be opened: another program has it open");
  termios raw{};
  tcgetattr(file, &raw);
  cfmakeraw(&raw);
  tcsetattr(file, TCSANOW, &raw);
  return port;
}

}  // namespace lodestone::rig
