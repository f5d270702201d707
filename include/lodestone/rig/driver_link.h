#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/json.h"
#include "lodestone/common/priority_mutex.h"
#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

constexpr int kDriverProtocol = 1;

/// A driver's answer, but no.
class DriverRefused final : public common::HardwareError {
 public:
  using HardwareError::HardwareError;
};

struct DriverReply {
  common::Json content;
  std::vector<std::uint8_t> bytes;  ///< an image

  /// A number of it. Throws HardwareError where there is none, or one outside the bounds.
  double number(const char* key, double least, double most) const;
};

/// Requests to a driver outside the program, and its replies (docs/driver-protocol.md): one at a time, each
/// answered in time or never asked again, for who does not answer once cannot be trusted with coils. Safe to
/// use from any thread.
class DriverLink {
 public:
  using OpenStream = std::function<std::unique_ptr<SerialPort>()>;

  /// Opens the stream and says hello as `role` (coils, camera or sensor), with what `hello` says besides.
  /// Throws HardwareError where nobody answers, or somebody of another protocol.
  DriverLink(const OpenStream& open, const std::string& role, common::Json hello, double start_timeout_s,
             double reply_timeout_s);

  /// As the driver calls itself.
  const std::string& name() const { return name_; }

  /// Throws DriverRefused, or HardwareError where nothing that can be understood came in time: from then on
  /// the link is closed, and a driver that was started is ended.
  DriverReply ask(const common::Json& request) { return ask(request, reply_timeout_s_); }
  DriverReply ask(const common::Json& request, double timeout_s);
  /// The same unless anybody has stopped the coils since there were so many stops(): then DriverRefused, and
  /// nothing is sent.
  DriverReply ask_unless_stopped(const common::Json& request, std::int64_t stops);
  /// A stop, at once, ahead of the answer that anybody waits for; returns when the driver has confirmed it.
  /// Throws as ask().
  void stop();
  /// So many were begun or confirmed.
  std::int64_t stops() const { return stops_; }
  bool is_open() const { return open_; }

 private:
  DriverReply answered(const common::Json& request, double timeout_s,
                       const std::function<DriverReply(double until_s)>& exchange);
  DriverReply await(std::int64_t id, const common::Json& request, double until_s);
  [[noreturn]] void throw_refused(const common::Json& request, const common::Json& error) const;
  DriverReply read_reply(double until_s);
  void read(std::uint8_t* bytes, std::size_t count, double until_s);
  std::int64_t send(const common::Json& request, std::optional<std::int64_t> stops = std::nullopt);
  void close() noexcept;

  common::PriorityMutex asking_;  // held from a request to its answer
  common::PriorityMutex writing_;
  std::unique_ptr<SerialPort> stream_;
  std::unique_ptr<common::SignalSafeStop> signal_safe_stop_;
  double reply_timeout_s_;
  bool images_;
  std::int64_t last_id_ = 0;
  std::int64_t answered_ahead_ = 0;  ///< the last stop that was answered to somebody else
  common::Json refused_ahead_;       ///< the error in that answer; null where there was none
  std::atomic<std::int64_t> stops_{0};
  std::atomic<bool> open_{true};
  std::string name_ = "driver";
};

}  // namespace lodestone::rig
