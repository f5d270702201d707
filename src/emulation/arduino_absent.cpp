#include "lodestone/common/error.h"
#include "lodestone/emulation/arduino.h"

namespace lodestone::emulation {

struct Arduino::State {};

Arduino::Arduino(Sink, Sink, std::size_t) {
  throw common::HardwareError(
      "this build cannot emulate the coil controller; install gcc-avr, avr-libc and libsimavr-dev and "
      "configure again");
}
Arduino::~Arduino() = default;
double Arduino::now_s() const { return 0.0; }
void Arduino::run_until(double) {}
void Arduino::host_byte(std::uint8_t) {}
void Arduino::controller_byte(std::uint8_t) {}
void Arduino::set_emergency_stop(bool) {}
bool Arduino::contactor() const { return false; }
void Arduino::hang() {}
int Arduino::resets() const { return 0; }

}  // namespace lodestone::emulation
