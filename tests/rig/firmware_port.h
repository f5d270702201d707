#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "firmware/device.h"
#include "lodestone/common/error.h"
#include "lodestone/rig/serial_port.h"

namespace lodestone::tests {

/// The coil controller's own code behind a port, with faults on the line. Shared with the ports that were
/// opened to it.
struct FirmwareBench {
  explicit FirmwareBench(std::uint8_t motor_controllers = 2) : device(motor_controllers) {}

  std::mutex mutex;  ///< of the rest: a test may look from another thread
  Device device;
  int opened = 0;
  bool plugged = true;
  std::vector<std::uint8_t> types;  ///< of the requests that have come
  wire::FrameDecoder decoder{};
  int lose_replies = 0;  ///< so many reads find nothing, and what came is lost

  bool on() {
    const std::lock_guard<std::mutex> lock(mutex);
    return device.on();
  }
};

/// A port to it. Time passes only in read().
class FirmwarePort final : public rig::SerialPort {
 public:
  explicit FirmwarePort(std::shared_ptr<FirmwareBench> bench) : bench_(std::move(bench)) {
    const std::lock_guard<std::mutex> lock(bench_->mutex);
    check();
    ++bench_->opened;
  }
  std::size_t read(std::uint8_t* bytes, std::size_t most, double timeout_s) override {
    const std::lock_guard<std::mutex> lock(bench_->mutex);
    check();
    std::vector<std::uint8_t>& sent = bench_->device.sent;
    if (bench_->lose_replies > 0) {
      --bench_->lose_replies;
      sent.clear();
    }
    bench_->device.run(sent.empty() ? 1e3 * timeout_s : 1.0);
    const std::size_t count = std::min(most, sent.size());
    std::copy(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(count), bytes);
    sent.erase(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  void write(const std::uint8_t* bytes, std::size_t count, double) override {
    const std::lock_guard<std::mutex> lock(bench_->mutex);
    check();
    for (std::size_t i = 0; i < count; ++i) {
      wire::Message message{};
      if (wire::decode_byte(&bench_->decoder, bytes[i], &message)) bench_->types.push_back(message.type);
      coils_host_byte(&bench_->device.coils, bytes[i]);
    }
  }
  void discard_input() override {
    const std::lock_guard<std::mutex> lock(bench_->mutex);
    bench_->device.sent.clear();
  }

 private:
  void check() const {
    if (!bench_->plugged) throw common::HardwareError("the cable is out");
  }
  std::shared_ptr<FirmwareBench> bench_;
};

}  // namespace lodestone::tests
