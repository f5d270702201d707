#include "lodestone/emulation/emulated_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodestone/common/error.h"
#include "lodestone/common/named.h"
#include "lodestone/physics/amplifier.h"

namespace lodestone::emulation {

namespace {

constexpr double kStep_s = 0.1e-3;  // about one byte on a line

/// As many as the coils need, two each, at addresses from 0x80 on.
std::vector<RoboClawModel> controllers_for(std::size_t coils) {
  std::vector<RoboClawModel> controllers;
  for (std::size_t c = 0; c < (coils + 1) / 2; ++c)
    controllers.emplace_back(static_cast<std::uint8_t>(0x80 + c));
  return controllers;
}

}  // namespace

class EmulatedBench::BenchClock final : public common::Clock {
 public:
  explicit BenchClock(EmulatedBench& bench) : bench_(bench) {}
  double now_s() const override { return bench_.now_s(); }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    if (interruption != nullptr && interruption->raised()) return false;
    bench_.advance_to(time_s);
    return true;
  }

 private:
  EmulatedBench& bench_;
};

EmulatedBench::EmulatedBench(rig::VirtualRig& rig)
    : rig_(rig),
      controllers_(controllers_for(rig.config().coils.count())),
      clock_(std::make_unique<BenchClock>(*this)),
      start_s_(rig.clock().now_s()),
      now_s_(start_s_) {
  const physics::AmplifierControl controls = rig.config().amplifier.controls;
  if (controls != physics::AmplifierControl::kDuty)
    throw common::ConfigError("rig.amplifier.controls = " + common::name_of(controls) +
                              "; the emulated motor controllers give duties: it must be duty");
  stuck_.assign(coil_count(), std::numeric_limits<double>::quiet_NaN());
  short_.assign(coil_count(), 1.0);
  set_supply_V(rig.config().supply_V);
  arduino_ = std::make_unique<Arduino>(
      [this](std::uint8_t byte) {
        to_host_.push_back({byte, arduino_->now_s() + start_s_ + RoboClawModel::kByte_s});
      },
      [this](std::uint8_t byte) {
        if (!to_controllers_filter || to_controllers_filter(byte))
          to_controllers_.push_back({byte, arduino_->now_s() + start_s_ + RoboClawModel::kByte_s});
      },
      controllers_.size());
}

EmulatedBench::~EmulatedBench() = default;

common::Clock& EmulatedBench::clock() { return *clock_; }

double EmulatedBench::now_s() const {
  const Lock lock(mutex_);
  return now_s_;
}

void EmulatedBench::host_write(const std::uint8_t* bytes, std::size_t count) {
  const Lock lock(mutex_);
  if (!plugged_) return;
  line_free_s_ = std::max(line_free_s_, now_s_);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint8_t byte = bytes[i];
    if (!to_device_filter || to_device_filter(byte)) to_device_.push_back({byte, line_free_s_});
    line_free_s_ += RoboClawModel::kByte_s;
  }
}

bool EmulatedBench::host_read(std::uint8_t& byte) {
  const Lock lock(mutex_);
  if (host_inbox_.empty()) return false;
  byte = host_inbox_.front();
  host_inbox_.pop_front();
  return true;
}

physics::PerCoil EmulatedBench::current_A() const { return rig_.coils().status().current_A; }

void EmulatedBench::set_plugged(bool plugged) {
  const Lock lock(mutex_);
  plugged_ = plugged;
  to_device_.clear();
  to_host_.clear();
  host_inbox_.clear();
}

void EmulatedBench::set_supply_V(double volt) { supply_V_ = volt; }

/// The contactor is slow; the motor controllers' electronics have a supply of their own.
void EmulatedBench::switch_supply(const physics::PerCoil& current_A) {
  if (arduino_->contactor() == contactor_closed_) contactor_s_ = now_s_;
  if (now_s_ - contactor_s_ >= contactor_takes_s_) contactor_closed_ = !contactor_closed_;
  const double left_V = physics::sagged_V(supply_V_, rig_.config().supply_resistance_ohm, current_A);
  for (RoboClawModel& controller : controllers_)
    controller.supply_V = contactor_closed_ || welded_ ? left_V : 0.0;
}

void EmulatedBench::stick_driver(int coil, double duty) { stuck_[static_cast<std::size_t>(coil)] = duty; }

void EmulatedBench::short_coil(int coil, double fraction) {
  LODESTONE_CHECK(fraction > 0.0, "a fraction above 0");
  short_[static_cast<std::size_t>(coil)] = fraction;
}

void EmulatedBench::heat_coil(int coil, double temperature_C) {
  common::Json state = rig_.save();
  state["coils"][static_cast<std::size_t>(coil)][1] = temperature_C;
  rig_.restore(state);
}

void EmulatedBench::inject_to_device(const std::vector<std::uint8_t>& bytes) {
  line_free_s_ = std::max(line_free_s_, now_s_);
  for (const std::uint8_t byte : bytes) {
    to_device_.push_back({byte, line_free_s_});
    line_free_s_ += RoboClawModel::kByte_s;
  }
}

void EmulatedBench::inject_to_host(const std::vector<std::uint8_t>& bytes) {
  host_inbox_.insert(host_inbox_.end(), bytes.begin(), bytes.end());
}

/// What the controllers put on the coils from now on.
void EmulatedBench::drive_rig() {
  physics::PerCoil duty{};
  for (std::size_t i = 0; i < coil_count(); ++i)  // an odd one leaves the last output free
    duty[i] = (std::isnan(stuck_[i]) ? controllers_[i / 2].duty()[i % 2] : stuck_[i]) / short_[i];
  if (!contactor_closed_ && !welded_) duty.assign(duty.size(), 0.0);
  if (duty == driven_ && supply_V_ == driven_supply_V_) return;
  driven_ = duty;
  driven_supply_V_ = supply_V_;
  rig_.drive(duty, supply_V_);
}

void EmulatedBench::step_to(double time_s) {
  while (!to_device_.empty() && to_device_.front().time_s <= now_s_) {
    arduino_->host_byte(to_device_.front().byte);
    to_device_.pop_front();
  }
  std::uint8_t byte = 0;
  for (RoboClawModel& controller : controllers_)
    if (controller.send(now_s_, byte) && (!from_controllers_filter || from_controllers_filter(byte)))
      arduino_->controller_byte(byte);
  arduino_->run_until(time_s - start_s_);
  rig_.clock().sleep_until(time_s);
  now_s_ = time_s;
  const rig::CoilStatus coils = rig_.coils().status();
  for (std::size_t i = 0; i < coils.current_A.size(); ++i)
    controllers_[i / 2].current_A[i % 2] = shunt ? shunt(i, coils.current_A[i]) : coils.current_A[i];
  while (!to_controllers_.empty() && to_controllers_.front().time_s <= now_s_) {
    for (RoboClawModel& controller : controllers_)
      controller.receive(to_controllers_.front().byte, to_controllers_.front().time_s);
    to_controllers_.pop_front();
  }
  for (RoboClawModel& controller : controllers_) controller.advance(now_s_);
  switch_supply(coils.current_A);
  drive_rig();
  while (!to_host_.empty() && to_host_.front().time_s <= now_s_) {
    byte = to_host_.front().byte;
    to_host_.pop_front();
    if (plugged_ && (!to_host_filter || to_host_filter(byte))) host_inbox_.push_back(byte);
  }
  if (watch) watch(now_s_, coils.current_A);
}

void EmulatedBench::advance_to(double time_s) {
  LODESTONE_CHECK(std::isfinite(time_s), "a simulated clock cannot sleep for ever");
  for (;;) {  // step by step, so that nobody waits for long
    const Lock lock(mutex_);
    if (!(now_s_ < time_s)) return;
    step_to(std::min(time_s, now_s_ + kStep_s));
  }
}

}  // namespace lodestone::emulation
