#include "terminal_port.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"

namespace lodestone::rig {

namespace {

class TerminalPort final : public SerialPort {
 public:
  explicit TerminalPort(const std::string& name)
      : name_(name), file_(open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    if (file_ < 0)
      throw common::HardwareError("pseudo-terminal " + name + " cannot be opened: " + std::strerror(errno) +
                                  "; is the emulated bench still running?");
    // No TIOCEXCL: it outlives a killed process for as long as the other end is open.
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      close(file_);
      throw common::HardwareError("pseudo-terminal " + name +
                                  " cannot be opened: another program has it open");
    }
    termios raw{};
    tcgetattr(file_, &raw);
    cfmakeraw(&raw);
    tcsetattr(file_, TCSANOW, &raw);
  }
  ~TerminalPort() override { close(file_); }
  TerminalPort(const TerminalPort&) = delete;
  TerminalPort& operator=(const TerminalPort&) = delete;

  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override {
    if (!wait(POLLIN, timeout_s)) return 0;
    const ssize_t count = ::read(file_, bytes, most);
    if (count > 0) return static_cast<std::size_t>(count);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
    gone();
  }
  void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) override {
    const common::SteadyClock clock;
    const double end_s = clock.now_s() + timeout_s;
    for (std::size_t done = 0; done < count;) {
      const ssize_t written = ::write(file_, bytes + done, count - done);
      if (written > 0) done += static_cast<std::size_t>(written);
      if (written < 0 && errno != EAGAIN && errno != EINTR) gone();
      if (done < count && (clock.now_s() >= end_s || !wait(POLLOUT, end_s - clock.now_s())))
        throw common::HardwareError("pseudo-terminal " + name_ + " takes no bytes");
    }
  }
  void discard_input() override { tcflush(file_, TCIFLUSH); }
  int descriptor() const noexcept override { return file_; }

 private:
  [[noreturn]] void gone() const {
    throw common::HardwareError("pseudo-terminal " + name_ + " has gone: has the emulated bench ended?");
  }
  bool wait(short events, double timeout_s) const {
    pollfd watched{file_, events, 0};
    const int ready = poll(&watched, 1, static_cast<int>(std::ceil(1e3 * std::max(0.0, timeout_s))));
    if (ready > 0 && (watched.revents & events) == 0) gone();
    return ready > 0;
  }
  std::string name_;
  int file_;
};

}  // namespace

std::unique_ptr<SerialPort> open_terminal(const std::string& name) {
  return std::make_unique<TerminalPort>(name);
}

}  // namespace lodestone::rig
