#include "pseudo_terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ctime>

#include "lodestone/common/error.h"

namespace lodestone::emulation {

PseudoTerminal::PseudoTerminal()
    : device_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)), kept_(-1) {
  char name[128] = "";
  const bool made = device_ >= 0 && grantpt(device_) == 0 && unlockpt(device_) == 0 &&
                    ptsname_r(device_, name, sizeof name) == 0;
  if (made) kept_ = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (kept_ < 0) {
    const std::string why = std::strerror(errno);
    if (device_ >= 0) close(device_);
    throw common::HardwareError("no pseudo-terminal for the emulated serial line: " + why);
  }
  termios raw{};
  tcgetattr(kept_, &raw);
  cfmakeraw(&raw);
  tcsetattr(kept_, TCSANOW, &raw);
  name_ = name;
}

PseudoTerminal::~PseudoTerminal() {
  close(kept_);
  close(device_);
}

std::size_t PseudoTerminal::read(std::uint8_t* bytes, std::size_t most, double timeout_s) {
  pollfd watched{device_, POLLIN, 0};
  timespec wait{};
  wait.tv_nsec = static_cast<long>(1e9 * timeout_s);
  if (ppoll(&watched, 1, &wait, nullptr) <= 0) return 0;
  const ssize_t count = ::read(device_, bytes, most);
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void PseudoTerminal::write(const std::uint8_t* bytes, std::size_t count) {
  const ssize_t written = ::write(device_, bytes, count);
  static_cast<void>(written);
}

}  // namespace lodestone::emulation
