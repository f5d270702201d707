#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "lodestone/rig/serial_coils.h"
#include "serial_link.h"

namespace lodestone::rig {

/// A session with the coil controller: says hello, hands over the limits, waits until the motor controllers
/// are ready, and does all of it again after the link was lost. Safe to use from any thread.
class SerialSession {
 public:
  /// Connects. Throws HardwareError with what to do about it. Each coil has an output.
  SerialSession(const SerialConfig& config, const physics::CoilsDescription& coils,
                SerialLink::OpenPort open);

  /// The body of the reply. A lost link throws, and the next call connects anew.
  SerialLink::Bytes request(wire::MessageType type, const SerialLink::Bytes& body = {});
  /// Switches off, ahead of every request that waits. A pulse that is on its way throws in its own thread.
  /// Throws HardwareError when nobody confirms it.
  void stop();

  CoilControllerInfo info() const;
  std::int64_t repeats() const { return link_.repeats(); }
  std::int64_t connections() const { return connections_; }

 private:
  void ensure_connected();
  void say_hello();
  void hand_over_limits();
  void wait_until_ready();

  SerialConfig config_;
  physics::CoilsDescription coils_;
  std::uint8_t controllers_;  // that the coils are on
  mutable std::mutex mutex_;  // of all but the counts
  SerialLink link_;
  std::condition_variable stop_done_;
  std::atomic<std::int64_t> stops_{0};  // asked for
  CoilControllerInfo info_;
  std::atomic<std::int64_t> connections_{0};
};

}  // namespace lodestone::rig
