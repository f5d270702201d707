#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "coils/protocol.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

/// An answer, but no.
class RequestRefused final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

/// Nobody answers, or somebody who knows nothing of this session: the next call has to connect anew.
class LinkLost final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

[[noreturn]] void throw_pulse_given_up();

/// The line to the coil controller: frames, sequence numbers, repetition until a request is answered. Used by
/// one thread at a time, except for StopRequest and repeats().
class SerialLink {
 public:
  using OpenPort = std::function<std::unique_ptr<SerialPort>()>;
  using Bytes = std::vector<std::uint8_t>;

  SerialLink(OpenPort open_port, double reply_timeout_s, std::int64_t tries);

  /// Opens the port and begins to count at a random number.
  void open();
  void close() noexcept;
  bool is_open() const { return port_ != nullptr; }

  /// The body of the reply. Throws RequestRefused, or LinkLost when the port is gone or nobody answers.
  Bytes exchange(wire::MessageType type, const Bytes& body = {});
  /// Lets the port's time pass, the only one there is here.
  void wait(double time_s);

  /// While one exists, in any thread, a pulse that is on its way is given up, and whoever waits for an answer
  /// sends a stop within 10 ms.
  class StopRequest {
   public:
    explicit StopRequest(SerialLink& link) : link_(link) { ++link_.stop_requests_; }
    ~StopRequest() { --link_.stop_requests_; }
    StopRequest(const StopRequest&) = delete;
    StopRequest& operator=(const StopRequest&) = delete;

   private:
    SerialLink& link_;
  };

  bool stop_requested() const { return stop_requests_ > 0; }
  std::int64_t repeats() const { return repeats_; }
  double timeout_s() const { return static_cast<double>(tries_) * reply_timeout_s_; }

 private:
  void send(const Bytes& frame);
  /// False when nothing came in time.
  bool receive(wire::MessageType type, bool& stop_sent, Bytes& body);

  OpenPort open_port_;
  double reply_timeout_s_;
  std::int64_t tries_;
  std::unique_ptr<SerialPort> port_;
  std::unique_ptr<common::SignalSafeStop> signal_safe_stop_;
  wire::FrameDecoder decoder_{};
  std::uint16_t sequence_ = 0;
  std::atomic<std::int64_t> repeats_{0};
  std::atomic<int> stop_requests_{0};
};

}  // namespace lodestone::rig
