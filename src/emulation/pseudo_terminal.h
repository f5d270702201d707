#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace lodestone::emulation {

/// The device's end of a serial line whose other end programs open by name.
class PseudoTerminal {
 public:
  /// Throws HardwareError.
  PseudoTerminal();
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  const std::string& name() const { return name_; }
  /// Bytes that have come, waiting at most `timeout_s` for the first.
  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s);
  /// What does not fit is lost, as on a line that nobody reads.
  void write(const std::uint8_t* bytes, std::size_t count);

 private:
  int device_;
  int kept_;  // the other end: keeps the line up while no program has it open
  std::string name_;
};

}  // namespace lodestone::emulation
