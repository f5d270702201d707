#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace lodestone::emulation {

/// An ATmega2560 at 16 MHz that runs the real firmware image, cycle by cycle (simavr). Use from one thread.
class Arduino {
 public:
  using Sink = std::function<void(std::uint8_t byte)>;

  /// Starts the firmware for so many motor controllers (1 to 8). `to_host` and `to_controllers` get the bytes
  /// of UART0 and UART1 as their transmission starts. Throws HardwareError when this build has no emulator.
  Arduino(Sink to_host, Sink to_controllers, std::size_t motor_controllers = 2);
  ~Arduino();
  Arduino(const Arduino&) = delete;
  Arduino& operator=(const Arduino&) = delete;

  /// Since the start, in simulated time.
  double now_s() const;
  void run_until(double time_s);

  /// A byte that starts to arrive now. At most one per 87 us and line.
  void host_byte(std::uint8_t byte);
  void controller_byte(std::uint8_t byte);

  /// The switch on pin 22: open means stop.
  void set_emergency_stop(bool open);
  /// Pin 23: the contactor in the supply of the coils is told to close. False while the pin is no output.
  bool contactor() const;
  /// The main loop stops where it is and interrupts go on, until a reset: what a mistake in the firmware
  /// would do.
  void hang();
  /// How often the watchdog (or anything else) has reset the chip.
  int resets() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::emulation
