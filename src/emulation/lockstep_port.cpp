#include "lodestone/emulation/lockstep_port.h"

#include <algorithm>

#include "lodestone/common/error.h"

namespace lodestone::emulation {

namespace {
constexpr double kLockstep_s = 0.1e-3;
}

LockstepPort::LockstepPort(EmulatedBench& bench) : bench_(bench) { check(); }

void LockstepPort::check() const {
  if (!bench_.plugged())
    throw common::HardwareError("serial port of the emulated bench has gone: was the cable pulled?");
}

std::size_t LockstepPort::read(std::uint8_t* bytes, std::size_t most, double timeout_s) {
  const double end_s = bench_.now_s() + timeout_s;
  std::size_t count = 0;
  for (;;) {
    check();
    while (count < most && bench_.host_read(bytes[count])) ++count;
    if (count > 0 || bench_.now_s() >= end_s) return count;
    bench_.advance_to(std::min(end_s, bench_.now_s() + kLockstep_s));
  }
}

void LockstepPort::write(const std::uint8_t* bytes, std::size_t count, double) {
  check();
  bench_.host_write(bytes, count);
}

void LockstepPort::discard_input() {
  check();
  std::uint8_t byte = 0;
  while (bench_.host_read(byte)) {
  }
}

}  // namespace lodestone::emulation
