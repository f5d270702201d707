#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

namespace lodestone::emulation {

/// A RoboClaw 2x30A as its packet-serial manual tells: address, command, big-endian data, CRC-16; signed duty
/// with ramps, current limits, and a serial timeout of its own. Time is the caller's and never goes back.
class RoboClawModel {
 public:
  static constexpr double kByte_s = 10.0 / 115200.0;  ///< a byte on its line, 115,200 baud 8N1

  explicit RoboClawModel(std::uint8_t address) : address_(address) {}

  /// One byte from the line. A gap over 10 ms discards what came before.
  void receive(std::uint8_t byte, double now_s);
  /// Takes the next byte of an answer when its time has come.
  bool send(double now_s, std::uint8_t& byte);
  /// Ramps, serial timeout and current limit up to `now_s`.
  void advance(double now_s);
  /// Loses everything that was set, as at power-on.
  void restart();
  /// Loses what was set, and its timeout with it, but goes on with its duties: its memory is damaged.
  void forget_settings();

  /// Share of the supply on each motor output, -1 to 1.
  std::array<double, 2> duty() const;

  std::array<double, 2> current_A{};  ///< what its shunts see; the bench writes it
  double supply_V = 34.0;
  double board_C = 30.0;
  bool powered = true;          ///< false: dead and off
  bool rx_open = false;         ///< hears nothing (its receiving line is cut)
  bool tx_open = false;         ///< answers nothing (its sending line is cut)
  bool emergency_stop = false;  ///< its own S3 input

 private:
  struct Output {
    double duty = 0.0;       // counts, +-32767
    double target = 0.0;     // counts
    double ramp = 655359.0;  // counts/s
    double max_current_A = 60.0;
    double over_since_s = -1.0;
    bool tripped = false;
  };
  bool handle_packet();
  std::vector<std::uint8_t> reading(std::uint8_t command) const;  ///< data of an answer
  void carry_out(std::uint8_t command, const std::uint8_t* data);
  void answer(const std::vector<std::uint8_t>& data);
  std::uint32_t status() const;

  std::uint8_t address_;
  double now_s_ = 0.0;
  double heard_s_ = 0.0;
  double last_byte_s_ = 0.0;
  double timeout_s_ = 0.0;  // none, as delivered
  std::vector<std::uint8_t> packet_;
  std::array<Output, 2> outputs_;
  struct Timed {
    std::uint8_t byte;
    double time_s;
  };
  std::deque<Timed> answer_;
};

}  // namespace lodestone::emulation
