#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/serial_port.h"

namespace lodestone::rig {

/// The coil controller on the serial port, and its limits.
struct SerialConfig {
  std::string port;
  std::int64_t baud = 115200;
  double reply_timeout_s = 0.05;
  std::int64_t tries = 4;
  double setup_timeout_s = 3.0;
  double max_pulse_s = 0.5;
  double max_duty = 0.6;
  double duty_window_s = 10.0;
  double min_supply_V = 20.0;
  double max_board_C = 80.0;
  double max_coil_C = 110.0;
  std::vector<std::int64_t> output;  // [coils], or empty

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("port", port, "", "serial port of the coil controller, such as /dev/ttyACM0");
    v.field("baud", baud, "baud", "speed of the port; the firmware has 115200", {1200, 4000000});
    v.field("reply_timeout_s", reply_timeout_s, "s", "how long an answer may take", {0.01, 0.1});
    v.field("tries", tries, "", "how often a request is sent before the controller counts as silent", {1, 5});
    v.field("setup_timeout_s", setup_timeout_s, "s", "how long the motor controllers may take to get ready",
            {0.5, 60.0});
    v.retired("max_current_A", "rig.coils.max_current_A");
    v.retired("resistance_ohm", "rig.coils.resistance_20C_ohm");
    v.retired("inductance_H", "rig.coils.inductance_H");
    v.retired("polarity", "rig.coils.polarity");
    v.field(
        "max_pulse_s", max_pulse_s, "s",
        "the firmware refuses longer pulses, and takes half a second without a word from here for a PC that "
        "is gone",
        {0.001, 0.5});
    v.field("max_duty", max_duty, "", "fraction of time that a coil may be on", {0.01, 0.9});
    v.field("duty_window_s", duty_window_s, "s", "over about this time", {0.1, 60.0});
    v.field("min_supply_V", min_supply_V, "V", "a supply below this stops the coils", {6.0, 34.0});
    v.field("max_board_C", max_board_C, "C", "a motor controller above this stops the coils", {30.0, 85.0});
    v.field("max_coil_C", max_coil_C, "C", "a coil whose resistance tells more than this stops the coils",
            {30.0, 155.0});
    v.field(
        "output", output, "",
        "where each coil is connected, in the order in which they are listed (+x, -x, +y, -y): 1 and 2 are "
        "M1 and M2 of the motor controller 0x80, 3 and 4 those of 0x81, and so on to 16; []: 1, 2, 3, ...",
        {1.0, 16.0});
  }
  /// Throws ConfigError when an output is named twice, or there is none of that number.
  void validate() const;
  /// Index on the wire of the output that a coil is connected to.
  std::size_t output_of(std::size_t coil) const {
    return output.empty() ? coil : static_cast<std::size_t>(output[coil] - 1);
  }
  /// How many motor controllers so many coils need: up to the last one that drives a coil.
  std::size_t controllers_for(std::size_t coils) const;
};

/// What the coil controller says of itself.
struct CoilControllerInfo {
  int protocol = 0;
  std::string firmware;       ///< "1.2.1"
  int motor_controllers = 0;  ///< that it was built for, two outputs each
  int reset_cause = 0;        ///< MCUSR of the ATmega2560: 1 power, 2 reset, 4 brown-out, 8 watchdog
};

struct CoilControllerState {
  bool ready = false;
  bool pulsing = false;
  bool emergency_stop = false;  ///< the switch is open now
  double uptime_s = 0.0;
  std::int64_t pulses = 0;       ///< since it started, modulo 65536
  std::vector<double> supply_V;  ///< [motor controllers]
  std::vector<double> board_C;   ///< [motor controllers]
  physics::PerCoil current_A{};
  physics::PerCoil resistance_ohm{};  ///< as the last long enough pulse told it
  std::vector<std::string> faults;
};

/// Current of the strongest coil of the last pulse, from its beginning.
struct CurrentTrace {
  int coil = 0;
  std::vector<std::pair<double, double>> samples;  ///< s, A
};

class SerialSession;

/// The coils behind the coil controller (firmware/coils; docs/serial-protocol.md), as many as the rig has.
/// One request at a time, repeated until answered; repetitions never fire a pulse twice. Whatever call finds
/// the port gone or the controller silent throws, and the next one connects anew. While it exists, a program
/// that dies of a signal still sends a stop; one that is killed outright is caught by the firmware, which
/// cuts a pulse after 500 ms of silence. Temperatures are those that the coils' resistance tells. Safe to use
/// from any thread: stop() goes ahead of every request that waits, and a pulse that another thread has on its
/// way throws there.
class SerialCoils final : public Coils {
 public:
  using OpenPort = std::function<std::unique_ptr<SerialPort>()>;

  /// Connects, hands over the limits and waits until the motor controllers are ready. Throws HardwareError
  /// with what to do about it, also where the firmware was built for another number of motor controllers than
  /// the rig's coils are on, and ConfigError where not every coil has an output.
  SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils);
  SerialCoils(const SerialConfig& config, const physics::CoilsDescription& coils, OpenPort open);
  ~SerialCoils() override;
  SerialCoils(const SerialCoils&) = delete;
  SerialCoils& operator=(const SerialCoils&) = delete;

  void apply(const CoilPulse& pulse) override;
  void stop() noexcept override;
  CoilStatus status() override;

  CoilControllerInfo info() const;
  CoilControllerState state();
  CurrentTrace trace();
  const physics::CoilsDescription& description() const { return coils_; }
  /// Which motor controller drives a coil, from 0.
  std::size_t controller_of(std::size_t coil) const { return config_.output_of(coil) / 2; }
  /// How often a request had to be repeated, and how often the connection was made.
  std::int64_t repeats() const;
  std::int64_t connections() const;
  /// Nothing but an answer: for measuring the way there and back.
  void ping();
  /// Forgets the latched faults; those that persist come back at once. An operator's decision, never a
  /// program's.
  void clear_faults();

 private:
  SerialConfig config_;
  physics::CoilsDescription coils_;
  std::uint8_t controllers_;  // that the coils are on
  std::unique_ptr<SerialSession> session_;
};

}  // namespace lodestone::rig
