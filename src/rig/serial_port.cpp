#include "lodestone/rig/serial_port.h"

#include <fcntl.h>
#include <libserialport.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>

#include "lodestone/common/error.h"
#include "terminal_port.h"

namespace lodestone::rig {

namespace {

unsigned int milliseconds(double seconds) {
  // 0 would mean "for ever" to the library.
  return static_cast<unsigned int>(std::max(1.0, std::ceil(1e3 * seconds)));
}

std::string reason_for(const std::string& name, int code) {
  if (access(name.c_str(), F_OK) != 0) return "there is no such port";
  if (access(name.c_str(), R_OK | W_OK) != 0)
    return "this user may not use it; add the user to the group that owns it (often dialout) and log in "
           "again";
  if (code == EBUSY) return "another program has it open";
  return std::strerror(code);
}

std::string known_ports() {
  std::string names;
  for (const SerialPortInfo& port : list_serial_ports())
    names += (names.empty() ? "" : ", ") + port.name +
             (port.description.empty() ? "" : " (" + port.description + ")");
  return names.empty() ? "no serial port was found: is the cable plugged in?" : "ports found: " + names;
}

class LibSerialPort final : public SerialPort {
 public:
  LibSerialPort(const std::string& name, int baud) : name_(name) {
    if (name.empty()) throw common::ConfigError("rig.serial.port is empty; " + known_ports());
    if (sp_get_port_by_name(name.c_str(), &port_) != SP_OK || sp_open(port_, SP_MODE_READ_WRITE) != SP_OK) {
      const int code = errno;
      sp_free_port(port_);
      throw common::HardwareError("serial port " + name + " cannot be opened: " + reason_for(name, code) +
                                  "; " + known_ports());
    }
    int handle = -1;
    sp_get_port_handle(port_, &handle);
    // Programs that are started from here, such as a camera's, would hold the lock when this one is gone.
    if (handle >= 0) fcntl(handle, F_SETFD, FD_CLOEXEC);
    // Two programs at one bench would each believe that they know what the coils do. The lock comes before
    // anything is set, and binds root, too; TIOCEXCL keeps out programs that ask for no lock.
    if (handle < 0 || flock(handle, LOCK_EX | LOCK_NB) != 0 || ioctl(handle, TIOCEXCL) != 0) {
      close();
      throw common::HardwareError("serial port " + name + " cannot be opened: another program has it open");
    }
    const bool set = sp_set_baudrate(port_, baud) == SP_OK && sp_set_bits(port_, 8) == SP_OK &&
                     sp_set_parity(port_, SP_PARITY_NONE) == SP_OK && sp_set_stopbits(port_, 1) == SP_OK &&
                     sp_set_flowcontrol(port_, SP_FLOWCONTROL_NONE) == SP_OK;
    if (!set) {
      ioctl(handle, TIOCNXCL);
      close();
      throw common::HardwareError("serial port " + name + ": it does not take " + std::to_string(baud) +
                                  " baud");
    }
    handle_ = handle;
  }
  ~LibSerialPort() override { close(); }
  LibSerialPort(const LibSerialPort&) = delete;
  LibSerialPort& operator=(const LibSerialPort&) = delete;

  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override {
    // The library takes a port that has gone for one that is quiet.
    const auto start = std::chrono::steady_clock::now();
    const int count = sp_blocking_read_next(port_, bytes, most, milliseconds(timeout_s));
    if (count < 0) gone();
    if (count == 0) {
      const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - start;
      if (waited.count() < 0.5 * timeout_s || sp_input_waiting(port_) < 0) gone();
    }
    return static_cast<std::size_t>(count);
  }
  void write(const std::uint8_t* bytes, std::size_t count, double timeout_s) override {
    const int written = sp_blocking_write(port_, bytes, count, milliseconds(timeout_s));
    if (written < 0) gone();
    if (static_cast<std::size_t>(written) < count)
      throw common::HardwareError("serial port " + name_ + " takes no bytes");
  }
  void discard_input() override {
    if (sp_flush(port_, SP_BUF_INPUT) != SP_OK) gone();
  }
  int descriptor() const noexcept override { return handle_; }

 private:
  [[noreturn]] void gone() const {
    throw common::HardwareError("serial port " + name_ + " has gone: was the cable pulled?");
  }
  void close() {
    if (port_ == nullptr) return;
    if (handle_ >= 0) ioctl(handle_, TIOCNXCL);
    sp_close(port_);
    sp_free_port(port_);
    port_ = nullptr;
  }
  std::string name_;
  sp_port* port_ = nullptr;
  int handle_ = -1;
};

}  // namespace

std::unique_ptr<SerialPort> open_serial_port(const std::string& name, int baud) {
  if (name.rfind("/dev/pts/", 0) == 0) return open_terminal(name);
  return std::make_unique<LibSerialPort>(name, baud);
}

std::vector<SerialPortInfo> list_serial_ports() {
  std::vector<SerialPortInfo> found;
  sp_port** ports = nullptr;
  if (sp_list_ports(&ports) != SP_OK) return found;
  for (sp_port** port = ports; *port != nullptr; ++port) {
    const char* description = sp_get_port_description(*port);
    found.push_back({sp_get_port_name(*port), description != nullptr ? description : ""});
  }
  sp_free_port_list(ports);
  return found;
}

}  // namespace lodestone::rig
