#pragma once

#include <cstdint>
#include <vector>

namespace lodestone::common {

/// From here on Ctrl-C and SIGTERM set a flag instead of ending the program; a second Ctrl-C ends it at once.
void install_interrupt_handler();

/// True once the user asked to stop. Long loops look, save a checkpoint and throw Interrupted.
bool interrupted() noexcept;

/// Bytes that are written to a file descriptor should a signal end the program (a fault, a closed terminal,
/// an abort, a second Ctrl-C) while this object lives: how a dying program still switches a device off.
/// Nothing helps against `kill -9`. At most eight at a time; LogicFault beyond.
class SignalSafeStop {
 public:
  SignalSafeStop(int descriptor, std::vector<std::uint8_t> bytes);
  ~SignalSafeStop();
  SignalSafeStop(const SignalSafeStop&) = delete;
  SignalSafeStop& operator=(const SignalSafeStop&) = delete;

 private:
  int slot_;
};

}  // namespace lodestone::common
