#pragma once

#include <string>

#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

/// A byte stream over a file descriptor that does not block: a pseudo-terminal, or a socket.
class DescriptorPort : public SerialPort {
 public:
  /// Owns `file`. Errors begin with `name` ("pseudo-terminal /dev/pts/3") and ask `gone` when it has ended
  /// ("has the emulated bench ended?").
  DescriptorPort(int file, std::string name, std::string gone);
  ~DescriptorPort() override;
  DescriptorPort(const DescriptorPort&) = delete;
  DescriptorPort& operator=(const DescriptorPort&) = delete;

  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override;
  void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) override;
  void discard_input() override;
  int descriptor() const noexcept override { return file_; }

 protected:
  /// No more bytes either way.
  void close() noexcept;

 private:
  [[noreturn]] void gone() const;
  bool wait(short events, double timeout_s) const;

  int file_;
  std::string name_;
  std::string gone_;
};

}  // namespace lodestone::rig
