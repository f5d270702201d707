#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "lodestone/physics/coils_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/driver_config.h"
#include "lodestone/rig/driver_link.h"

namespace lodestone::rig {

class CurrentWatch;

/// What a driver of coils has to know: their limits, as they are wired (CoilsDescription::polarity), and
/// after how much silence it switches off.
common::Json coils_hello(const physics::CoilsDescription& coils, double max_pulse_s);
/// Reads what a driver says of its coils. Throws HardwareError where that is no status of so many coils.
CoilStatus coil_status(const common::Json& content, std::size_t coils);
/// What a driver keeps (docs/driver-protocol.md): so long it may hear nothing while a pulse is on, as the
/// firmware; a coil that is switched off has less than this, so long after.
constexpr double kDriverSilence_s = 0.5;
constexpr double kDriverOff_A = 0.3;
constexpr double kDriverOffWithin_s = 0.15;

/// Coils behind a driver outside the program (docs/driver-protocol.md). While a current may flow, a thread
/// asks for the currents, once they are steady and then every 50 ms: what cannot be, or no answer, switches
/// the coils off and is a fault until clear_faults(). A driver that was started and does not answer is ended.
/// Safe to use from any thread: stop() goes ahead of every request that waits, and a pulse that another
/// thread has on its way throws there.
class DriverCoils final : public Coils {
 public:
  /// Throws ConfigError for an address that is none, HardwareError where the driver cannot be reached or does
  /// not fit.
  DriverCoils(const DriverConfig& config, const physics::CoilsDescription& coils);
  DriverCoils(const DriverConfig& config, const physics::CoilsDescription& coils,
              const DriverLink::OpenStream& open);
  ~DriverCoils() override;
  DriverCoils(const DriverCoils&) = delete;
  DriverCoils& operator=(const DriverCoils&) = delete;

  void apply(const CoilPulse& pulse) override;
  void stop() noexcept override;
  CoilStatus status() override;

  /// As the driver calls itself.
  const std::string& driver() const { return link_.name(); }
  /// Forgets what was latched, here and in the driver. An operator's decision, never a program's.
  void clear_faults();

 private:
  void check(const CoilPulse& pulse) const;
  CoilStatus watched_status();
  void latch(const std::string& fault);
  void watch_on();

  DriverConfig config_;
  physics::CoilsDescription coils_;
  DriverLink link_;
  common::PriorityMutex order_;  // a pulse, or a measurement, with what the watch is told of it
  common::PriorityMutex mutex_;  // of what follows
  std::condition_variable_any changed_;
  std::unique_ptr<CurrentWatch> watch_;
  std::string fault_;
  std::int64_t pulses_ = 0;
  bool ending_ = false;
  std::atomic<bool> told_{false};  // that a stop was not confirmed
  std::thread thread_;
};

}  // namespace lodestone::rig
