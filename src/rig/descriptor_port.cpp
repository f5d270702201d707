#include "descriptor_port.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"

namespace lodestone::rig {

namespace {

/// A socket that nobody reads is an error here, and no signal.
ssize_t written_to(int file, const std::uint8_t* bytes, std::size_t count) {
  const ssize_t written = send(file, bytes, count, MSG_NOSIGNAL);
  return written < 0 && errno == ENOTSOCK ? ::write(file, bytes, count) : written;
}

}  // namespace

DescriptorPort::DescriptorPort(int file, std::string name, std::string gone)
    : file_(file), name_(std::move(name)), gone_(std::move(gone)) {}

DescriptorPort::~DescriptorPort() { close(); }

void DescriptorPort::close() noexcept {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void DescriptorPort::gone() const { throw common::HardwareError(name_ + " has gone: " + gone_); }

bool DescriptorPort::wait(short events, double timeout_s) const {
  pollfd watched{file_, events, 0};
  const int ready = poll(&watched, 1, static_cast<int>(std::ceil(1e3 * std::max(0.0, timeout_s))));
  if (ready > 0 && (watched.revents & events) == 0) gone();
  return ready > 0;
}

std::size_t DescriptorPort::read(std::uint8_t* bytes, std::size_t most, double timeout_s) {
  if (!wait(POLLIN, timeout_s)) return 0;
  const ssize_t count = ::read(file_, bytes, most);
  if (count > 0) return static_cast<std::size_t>(count);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  gone();
}

void DescriptorPort::write(const std::uint8_t* bytes, std::size_t count, double timeout_s) {
  const common::SteadyClock clock;
  const double end_s = clock.now_s() + timeout_s;
  for (std::size_t done = 0; done < count;) {
    const ssize_t written = written_to(file_, bytes + done, count - done);
    if (written > 0) done += static_cast<std::size_t>(written);
    if (written < 0 && errno != EAGAIN && errno != EINTR) gone();
    if (done < count && (clock.now_s() >= end_s || !wait(POLLOUT, end_s - clock.now_s())))
      throw common::HardwareError(name_ + " takes no bytes");
  }
}

void DescriptorPort::discard_input() {
  std::uint8_t bytes[256];
  while (::read(file_, bytes, sizeof bytes) > 0) {
  }
}

}  // namespace lodestone::rig
