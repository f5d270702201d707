#pragma once

#include <cstdint>
#include <vector>

namespace lodestone::common {

/// From here on Ctrl-C and SIGTERM set a flag instead of ending the program; a second Ctrl-C ends it at once.
/// A file that may not grow is an error of its write, and no signal, unless there is a device to switch off.
void install_interrupt_handler();

/// True once the user asked to stop. Long loops look, save a checkpoint and throw Interrupted.
bool interrupted() noexcept;

/// Bytes that are written to a file descriptor should a signal end the program (a fault, a stack overflow of
/// the thread that made this object, a closed terminal, a limit or a timer of the system, a second Ctrl-C)
/// while this object lives: how a dying program still switches a device off. Nothing helps against `kill -9`.
/// At most eight at a time; LogicFault beyond.
class SignalSafeStop {
 public:
  SignalSafeStop(int descriptor, std::vector<std::uint8_t> bytes);
  ~SignalSafeStop();
  SignalSafeStop(const SignalSafeStop&) = delete;
  SignalSafeStop& operator=(const SignalSafeStop&) = delete;

 private:
  int slot_;
};

/// Held while bytes go to a device that a SignalSafeStop may switch off: a signal waits for the end of the
/// write (at most 50 ms), so that nothing follows its bytes. Throws Interrupted when a signal has spoken
/// already. One at a time in a thread.
class DeviceWrite {
 public:
  DeviceWrite();
  ~DeviceWrite();
  DeviceWrite(const DeviceWrite&) = delete;
  DeviceWrite& operator=(const DeviceWrite&) = delete;
};

/// Standard input hands over every key at once, unseen, while this lives; a signal that ends the program puts
/// it back as it was. One at a time; standard input has to be a terminal.
class RawTerminal {
 public:
  RawTerminal();
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;
};

}  // namespace lodestone::common
