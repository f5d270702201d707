#pragma once

#include "lodestone/emulation/emulated_bench.h"
#include "lodestone/rig/serial_port.h"

namespace lodestone::emulation {

/// The PC's end of an emulated bench's serial line, without real time: waiting for bytes is what advances the
/// bench. The same run always gives the same result, as fast as the machine can.
class LockstepPort final : public rig::SerialPort {
 public:
  /// Throws HardwareError when the bench is unplugged. `bench` must outlive the port.
  explicit LockstepPort(EmulatedBench& bench);

  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override;
  void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) override;
  void discard_input() override;

 private:
  void check() const;
  EmulatedBench& bench_;
};

}  // namespace lodestone::emulation
