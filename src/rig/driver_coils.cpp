#include "lodestone/rig/driver_coils.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "current_watch.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/log.h"
#include "lodestone/common/realtime.h"
#include "lodestone/common/shown.h"
#include "lodestone/rig/driver_stream.h"

namespace lodestone::rig {

namespace {

double steady_now_s() { return common::SteadyClock().now_s(); }

physics::PerCoil numbers_of(const common::Json& content, const char* key, std::size_t coils) {
  const common::Json found = content.value(key, common::Json());
  const auto is_number = [](const common::Json& one) { return one.is_number(); };
  if (!found.is_array() || found.size() != coils || !std::all_of(found.begin(), found.end(), is_number))
    throw common::HardwareError(fmt::format("the driver's status has {} = {}, {} numbers belong there", key,
                                            common::shown_json(found), coils));
  return physics::PerCoil(found.get<std::vector<double>>());
}

}  // namespace

common::Json coils_hello(const physics::CoilsDescription& coils, double max_pulse_s) {
  common::Json each = common::Json::array();
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    common::Json not_with = common::Json::array();
    for (std::size_t other = 0; other < coils.count(); ++other)
      if (other != coil && coils.apart(coil, other)) not_with.push_back(coils.name(other));
    each.push_back(
        {{"name", coils.name(coil)},
         {"smallest_A", coils.polarity[coil] > 0 ? coils.smallest_A(coil) : -coils.largest_A(coil)},
         {"largest_A", coils.polarity[coil] > 0 ? coils.largest_A(coil) : -coils.smallest_A(coil)},
         {"resistance_20C_ohm", coils.resistance_20C_ohm[coil]},
         {"not_with", not_with}});
  }
  return {{"coils", each}, {"max_pulse_s", max_pulse_s}, {"silence_s", kDriverSilence_s}};
}

CoilStatus coil_status(const common::Json& content, std::size_t coils) {
  CoilStatus status;
  status.current_A = numbers_of(content, "current_A", coils);
  if (content.contains("temperature_C")) status.temperature_C = numbers_of(content, "temperature_C", coils);
  if (const auto supply = content.find("supply_V"); supply != content.end()) {
    if (!supply->is_number())
      throw common::HardwareError("the driver's status has supply_V = " + common::shown_json(*supply) +
                                  ", a number belongs there");
    status.supply_V = supply->get<double>();
  }
  const common::Json faults = content.value("faults", common::Json());
  const auto is_text = [](const common::Json& fault) { return fault.is_string(); };
  if (!faults.is_array() || !std::all_of(faults.begin(), faults.end(), is_text))
    throw common::HardwareError("the driver's status has faults = " + common::shown_json(faults) +
                                ", a list of texts belongs there");
  for (const common::Json& fault : faults) status.faults.push_back(common::shown(fault.get<std::string>()));
  return status;
}

DriverCoils::DriverCoils(const DriverConfig& config, const physics::CoilsDescription& coils)
    : DriverCoils(config, coils, [&config] {
        return open_driver_stream(config.coils, config.start_timeout_s, "rig.driver.coils");
      }) {}

DriverCoils::DriverCoils(const DriverConfig& config, const physics::CoilsDescription& coils,
                         const DriverLink::OpenStream& open)
    : config_(config),
      coils_(coils),
      link_(open, "coils", coils_hello(coils, config.max_pulse_s), config.start_timeout_s,
            config.reply_timeout_s),
      watch_(std::make_unique<CurrentWatch>(coils)) {
  coils_.validate();
  thread_ = std::thread([this] { watch_on(); });
}

DriverCoils::~DriverCoils() {
  stop();
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void DriverCoils::check(const CoilPulse& pulse) const {
  for (std::size_t coil = 0; coil < physics::kMostCoils; ++coil) {
    const bool there = coil < coils_.count();
    const double least_A = there ? coils_.smallest_A(coil) : 0.0;
    const double most_A = there ? coils_.largest_A(coil) : 0.0;
    if (!(pulse.current_A[coil] >= least_A && pulse.current_A[coil] <= most_A))
      throw common::HardwareError(fmt::format(
          "current of coil {} = {:g} A is refused; it must be within {:g} "
          "and {:g} A",
          there ? coils_.name(coil) : std::to_string(coil + 1), pulse.current_A[coil], least_A, most_A));
  }
  if (!(pulse.duration_s >= 0.0 && pulse.duration_s <= config_.max_pulse_s))
    throw common::HardwareError(
        fmt::format("duration = {:g} s is refused; it must be within 0 and {:g} s (rig.driver.max_pulse_s)",
                    pulse.duration_s, config_.max_pulse_s));
}

void DriverCoils::apply(const CoilPulse& pulse) {
  check(pulse);
  common::Json currents = common::Json::array();
  for (std::size_t coil = 0; coil < coils_.count(); ++coil)
    currents.push_back(pulse.current_A[coil] * static_cast<double>(coils_.polarity[coil]));
  const std::int64_t stops_before = link_.stops();
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    if (!fault_.empty()) throw common::HardwareError(fault_);
  }
  {
    const std::lock_guard<common::PriorityMutex> order(order_);
    const double asked_s = steady_now_s();
    link_.ask_unless_stopped({{"do", "pulse"}, {"current_A", currents}, {"duration_s", pulse.duration_s}},
                             stops_before);
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    watch_->pulse(pulse, asked_s, steady_now_s());
    ++pulses_;
    changed_.notify_all();
    if (link_.stops() == stops_before) return;
  }
  stop();
  throw common::HardwareError("the pulse was given up: another thread has stopped the coils");
}

void DriverCoils::stop() noexcept {
  const auto told_to_watch = [this] {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    watch_->stop(steady_now_s());
  };
  try {
    told_to_watch();
    link_.stop();
    told_to_watch();
  } catch (const std::exception& error) {
    try {
      if (!told_.exchange(true))
        common::log_error(
            std::string("stop: ") + error.what() +
            "; what the driver drives has to switch off by itself, cut the supply if it does not");
    } catch (...) {
    }
  } catch (...) {
  }
}

CoilStatus DriverCoils::watched_status() {
  CoilStatus status;
  std::string distrust;
  {
    const std::lock_guard<common::PriorityMutex> order(order_);
    const double asked_s = steady_now_s();
    status = coil_status(link_.ask({{"do", "status"}}).content, coils_.count());
    for (std::size_t coil = 0; coil < coils_.count(); ++coil)
      status.current_A[coil] *= static_cast<double>(coils_.polarity[coil]);
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    distrust = watch_->distrust(status.current_A, asked_s, steady_now_s());
  }
  if (!distrust.empty()) latch(distrust);
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  if (!fault_.empty()) status.faults.push_back(fault_);
  return status;
}

CoilStatus DriverCoils::status() {
  try {
    return watched_status();
  } catch (const common::HardwareError& error) {
    latch(error.what());
    throw;
  }
}

void DriverCoils::latch(const std::string& fault) {
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex_);
    if (fault_.empty()) fault_ = fault;
  }
  stop();
}

void DriverCoils::clear_faults() {
  link_.ask({{"do", "clear"}});
  const std::lock_guard<common::PriorityMutex> lock(mutex_);
  fault_.clear();
}

void DriverCoils::watch_on() {
  const common::RealtimeThread realtime;  // who drives may wait for it
  std::unique_lock<common::PriorityMutex> lock(mutex_);
  double last_s = 0.0;
  while (!ending_) {
    changed_.wait(lock, [this] { return ending_ || !watch_->over(); });
    const std::int64_t of = pulses_;
    const double wait_s = watch_->look_at_s(last_s) - steady_now_s();
    if (changed_.wait_for(lock, std::chrono::duration<double>(std::max(0.0, wait_s)),
                          [&] { return ending_ || pulses_ != of; }))
      continue;  // another pulse, another time to look
    if (!link_.is_open()) return;
    last_s = steady_now_s();
    lock.unlock();
    try {
      watched_status();
    } catch (const std::exception& error) {
      latch(error.what());
    }
    lock.lock();
  }
}

}  // namespace lodestone::rig
