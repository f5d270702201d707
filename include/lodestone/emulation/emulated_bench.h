#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/emulation/arduino.h"
#include "lodestone/emulation/roboclaw_model.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::emulation {

/// A bench made of the real firmware on an emulated Arduino, modelled motor controllers and a virtual rig
/// whose coils they drive: coil i is on output i, M1 (i even) or M2 of motor controller i / 2. The PC's side
/// of the serial line is host_write() and host_read(). All time is simulated and moves only in advance_to(),
/// which any thread may call, as it may use both ends of the line; the faults are put in by one thread at a
/// time.
class EmulatedBench {
 public:
  /// `rig` must outlive the bench, and from here on only the bench may move its clock. Of its description's
  /// drivers (amplifier) nothing is taken: the motor controllers have ramps and steps of their own. Throws
  /// ConfigError where the rig is none for them, HardwareError when this build has no emulator.
  explicit EmulatedBench(rig::VirtualRig& rig);
  ~EmulatedBench();

  double now_s() const;
  void advance_to(double time_s);
  /// The bench's time as a clock: sleeping advances it.
  common::Clock& clock();

  /// Bytes that the PC sends, one after the other at 115,200 baud.
  void host_write(const std::uint8_t* bytes, std::size_t count);
  /// The next byte that has arrived at the PC.
  bool host_read(std::uint8_t& byte);

  /// Currents in the coils now, A, in the rig's order. What the needle feels, not what anyone measured.
  physics::PerCoil current_A() const;
  rig::VirtualRig& rig() { return rig_; }
  Arduino& arduino() { return *arduino_; }
  std::size_t controllers() const { return controllers_.size(); }
  RoboClawModel& controller(int index) { return controllers_[static_cast<std::size_t>(index)]; }

  // Faults.
  /// The USB plug: pulled, nothing passes either way; the Arduino keeps its power.
  void set_plugged(bool plugged);
  bool plugged() const { return plugged_; }
  /// Sees and may change every byte on the serial line; `false` swallows it.
  using ByteFilter = std::function<bool(std::uint8_t& byte)>;
  ByteFilter to_device_filter;
  ByteFilter to_host_filter;
  /// The same for the bus between the Arduino and the motor controllers.
  ByteFilter to_controllers_filter;
  ByteFilter from_controllers_filter;
  /// Supply of all controllers' outputs, V; what they measure while the contactor is closed and no current
  /// makes it sag (supply_resistance_ohm of the rig).
  void set_supply_V(double volt);
  /// The contactor's contacts have welded together: it no longer opens.
  void weld_contactor(bool welded) { welded_ = welded; }
  /// How long the contactor takes to open or close.
  void set_contactor_s(double seconds) { contactor_takes_s_ = seconds; }
  /// What the shunt of a coil tells its motor controller instead of the current, A.
  std::function<double(std::size_t coil, double current_A)> shunt;
  /// A driver that sticks: this coil gets this duty whatever its controller says; NaN clears it.
  void stick_driver(int coil, double duty);
  /// A coil with shorted turns: its resistance falls to this fraction (and its inductance with it). Above 1:
  /// a bad contact.
  void short_coil(int coil, double fraction);
  /// Heats a coil to this temperature, at once.
  void heat_coil(int coil, double temperature_C);
  /// Bytes that nobody sent.
  void inject_to_device(const std::vector<std::uint8_t>& bytes);
  void inject_to_host(const std::vector<std::uint8_t>& bytes);
  /// Sees every step of the bench, for recordings and checks: time and currents.
  std::function<void(double now_s, const physics::PerCoil& current_A)> watch;

 private:
  using Lock = std::lock_guard<std::recursive_mutex>;  // the filters and `watch` may look at the bench
  class BenchClock;
  struct Timed {
    std::uint8_t byte;
    double time_s;
  };
  std::size_t coil_count() const { return rig_.config().coils.count(); }
  void step_to(double time_s);
  void switch_supply(const physics::PerCoil& current_A);
  void drive_rig();

  mutable std::recursive_mutex mutex_;
  rig::VirtualRig& rig_;
  std::unique_ptr<Arduino> arduino_;
  std::vector<RoboClawModel> controllers_;
  std::unique_ptr<BenchClock> clock_;
  double start_s_;  // of the rig's clock
  double now_s_;
  bool plugged_ = true;
  double supply_V_ = 0.0;
  bool welded_ = false;
  double contactor_s_ = 0.0;  ///< when the contactor was last told what it does already
  double contactor_takes_s_ = 20e-3;
  bool contactor_closed_ = false;
  double line_free_s_ = 0.0;
  physics::PerCoil stuck_;
  physics::PerCoil short_;
  physics::PerCoil driven_{};
  double driven_supply_V_ = 0.0;
  std::deque<Timed> to_device_;
  std::deque<Timed> to_host_;
  std::deque<std::uint8_t> host_inbox_;
  std::deque<Timed> to_controllers_;
};

}  // namespace lodestone::emulation
