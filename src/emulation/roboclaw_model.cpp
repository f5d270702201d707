#include "lodestone/emulation/roboclaw_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lodestone::emulation {

namespace {

constexpr double kThink_s = 1e-3;  // from the last byte of a request to the first of its answer
constexpr double kGap_s = 10e-3;
constexpr double kFullDuty = 32767.0;
constexpr double kTripAfter_s = 10e-3;
constexpr double kHotBoard_C = 100.0;
constexpr double kWarmBoard_C = 85.0;

std::uint16_t crc16(const std::vector<std::uint8_t>& bytes) {
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000u) != 0 ? (crc << 1) ^ 0x1021 : crc << 1);
  }
  return crc;
}

/// Bytes of data that follow a command and its checksum; -1 for a reading, which has neither; -2 for a
/// command this model does not know.
int data_bytes(std::uint8_t command) {
  switch (command) {
    case 14:
      return 1;
    case 32:
    case 33:
      return 2;
    case 34:
    case 68:
    case 69:
      return 4;
    case 133:
    case 134:
      return 8;
    case 15:
    case 24:
    case 49:
    case 82:
    case 83:
    case 90:
      return -1;
    default:
      return -2;
  }
}

std::int16_t signed16(const std::uint8_t* at) { return static_cast<std::int16_t>(at[0] << 8 | at[1]); }
std::uint32_t unsigned32(const std::uint8_t* at) {
  return static_cast<std::uint32_t>(at[0]) << 24 | static_cast<std::uint32_t>(at[1]) << 16 |
         static_cast<std::uint32_t>(at[2]) << 8 | at[3];
}
void put16(std::vector<std::uint8_t>& out, long value) {
  out.push_back(static_cast<std::uint8_t>(value >> 8));
  out.push_back(static_cast<std::uint8_t>(value));
}

}  // namespace

void RoboClawModel::restart() {
  const std::uint8_t address = address_;
  RoboClawModel fresh(address);
  fresh.now_s_ = now_s_;
  fresh.current_A = current_A;
  fresh.supply_V = supply_V;
  fresh.board_C = board_C;
  *this = fresh;
}

void RoboClawModel::forget_settings() {
  timeout_s_ = 0.0;
  for (Output& output : outputs_) {
    output.ramp = Output{}.ramp;
    output.max_current_A = Output{}.max_current_A;
  }
}

std::uint32_t RoboClawModel::status() const {
  std::uint32_t bits = emergency_stop ? 1u : 0u;
  if (board_C > kHotBoard_C) bits |= 1u << 1;
  if (board_C > kWarmBoard_C) bits |= 1u << 20;
  for (std::size_t i = 0; i < 2; ++i) {
    if (outputs_[i].tripped) bits |= 1u << (12 + i);
    if (std::abs(current_A[i]) > outputs_[i].max_current_A) bits |= 1u << (16 + i);
  }
  return bits;
}

void RoboClawModel::answer(const std::vector<std::uint8_t>& data) {
  if (tx_open) return;
  for (std::size_t i = 0; i < data.size(); ++i)
    answer_.push_back({data[i], now_s_ + kThink_s + static_cast<double>(i) * kByte_s});
}

std::vector<std::uint8_t> RoboClawModel::reading(std::uint8_t command) const {
  std::vector<std::uint8_t> reply;
  switch (command) {
    case 15:
      reply.push_back(static_cast<std::uint8_t>(std::lround(timeout_s_ * 10.0)));
      break;
    case 24:
      put16(reply, std::lround(supply_V * 10.0));
      break;
    case 49:
      for (const double current : current_A) put16(reply, std::lround(current * 100.0));
      break;
    case 82:
    case 83:
      put16(reply, std::lround(board_C * 10.0));
      break;
    default:
      put16(reply, static_cast<long>(status() >> 16));
      put16(reply, static_cast<long>(status() & 0xffffu));
  }
  return reply;
}

void RoboClawModel::carry_out(std::uint8_t command, const std::uint8_t* data) {
  switch (command) {
    case 14:
      timeout_s_ = data[0] / 10.0;
      break;
    case 32:
    case 33:
      outputs_[command - 32].target = signed16(data);
      break;
    case 34:
      outputs_[0].target = signed16(data);
      outputs_[1].target = signed16(data + 2);
      break;
    case 68:
    case 69:
      outputs_[command - 68].ramp = unsigned32(data);
      break;
    default:
      outputs_[command - 133].max_current_A = unsigned32(data) / 100.0;
      break;
  }
}

/// Carries out the packet when it is whole. True when it is done with, or of no use.
bool RoboClawModel::handle_packet() {
  if (packet_.size() < 2) return false;
  const int data = data_bytes(packet_[1]);
  const bool mine = packet_[0] == address_;
  if (data == -2) return true;
  if (data == -1) {
    if (!mine) return true;
    heard_s_ = now_s_;
    std::vector<std::uint8_t> reply = reading(packet_[1]);
    std::vector<std::uint8_t> covered = packet_;
    covered.insert(covered.end(), reply.begin(), reply.end());
    put16(reply, crc16(covered));
    answer(reply);
    return true;
  }
  const std::size_t whole = 2 + static_cast<std::size_t>(data) + 2;
  if (packet_.size() < whole) return false;
  const std::vector<std::uint8_t> covered(packet_.begin(), packet_.end() - 2);
  const auto sent = static_cast<std::uint16_t>(packet_[whole - 2] << 8 | packet_[whole - 1]);
  if (!mine || crc16(covered) != sent) return true;
  heard_s_ = now_s_;
  carry_out(packet_[1], packet_.data() + 2);
  answer({0xff});
  return true;
}

void RoboClawModel::receive(std::uint8_t byte, double now_s) {
  advance(now_s);
  if (!powered || rx_open) return;
  if (now_s - last_byte_s_ > kGap_s) packet_.clear();
  last_byte_s_ = now_s;
  packet_.push_back(byte);
  if (handle_packet()) packet_.clear();
}

bool RoboClawModel::send(double now_s, std::uint8_t& byte) {
  if (answer_.empty() || answer_.front().time_s > now_s) return false;
  byte = answer_.front().byte;
  answer_.pop_front();
  return powered;
}

void RoboClawModel::advance(double now_s) {
  const double step_s = now_s - now_s_;
  if (step_s <= 0.0) return;
  now_s_ = now_s;
  if (!powered) {
    outputs_ = {};
    timeout_s_ = 0.0;
    answer_.clear();
    packet_.clear();
    return;
  }
  const bool silent = timeout_s_ > 0.0 && now_s - heard_s_ > timeout_s_;
  for (std::size_t i = 0; i < 2; ++i) {
    Output& output = outputs_[i];
    if (silent || emergency_stop || output.tripped) {
      output.target = 0.0;
      output.duty = 0.0;
    }
    const double change = output.ramp * step_s;
    output.duty += std::clamp(output.target - output.duty, -change, change);
    if (std::abs(current_A[i]) <= output.max_current_A)
      output.over_since_s = -1.0;
    else if (output.over_since_s < 0.0)
      output.over_since_s = now_s;
    else if (now_s - output.over_since_s > kTripAfter_s)
      output.tripped = true;
  }
}

std::array<double, 2> RoboClawModel::duty() const {
  return {outputs_[0].duty / kFullDuty, outputs_[1].duty / kFullDuty};
}

}  // namespace lodestone::emulation
