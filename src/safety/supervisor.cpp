#include "lodestone/safety/supervisor.h"

#include <algorithm>

#include "lodestone/common/log.h"
#include "lodestone/safety/deadline_check.h"
#include "lodestone/safety/device_check.h"
#include "lodestone/safety/duty_check.h"
#include "lodestone/safety/fence_check.h"
#include "lodestone/safety/pose_age_check.h"
#include "lodestone/safety/pulse_limits.h"
#include "lodestone/safety/temperature_check.h"

namespace lodestone::safety {
namespace {

/// But for what moves.
geometry::KeepOut keeps_out_fixed(const SafetyConfig& config, const physics::RigDescription& rig) {
  const double length_m = rig.needle.is_sphere() ? 0.0 : rig.needle.length_m;
  return {config.keep_out, length_m, rig.needle.diameter_m, config.keep_out_margin_m};
}

}  // namespace

geometry::KeepOut SafetyConfig::keeps_out(const physics::RigDescription& rig) const {
  geometry::KeepOut now = keeps_out_fixed(*this, rig);
  ZonesFile file(keep_out_file);
  now.zones.insert(now.zones.end(), file.zones().begin(), file.zones().end());
  return now;
}

Supervisor::Supervisor(rig::Coils& coils, const SafetyConfig& config, const physics::RigDescription& rig,
                       const common::Clock& clock, Poses poses, bool keys)
    : coils_(coils),
      clock_(clock),
      operator_(config.stop_file, keys),
      thermal_(rig),
      needle_seen_(config.max_pose_age_s),
      needle_required_(poses == Poses::kRequired),
      last_s_(clock.now_s()) {
  // In this order: the first that does not trust what it sees gives the reason.
  step_checks_.push_back(std::make_unique<DeadlineCheck>(config.max_late_s, config.max_late_steps));
  pose_checks_.push_back(std::make_unique<PoseAgeCheck>(config.max_pose_age_s));
  pose_checks_.push_back(std::make_unique<FenceCheck>(config.geofence * rig.dish.radius_m));
  auto keep_out = std::make_unique<KeepOutCheck>(keeps_out_fixed(config, rig), config.keep_out_file);
  keep_out_ = keep_out.get();
  pose_checks_.push_back(std::move(keep_out));
  pulse_checks_.push_back(
      std::make_unique<PulseLimits>(std::min(config.max_current_A, rig.coils.max_current_A),
                                    config.max_power_W, config.max_pulse_s, rig.coils, thermal_));
  pulse_checks_.push_back(std::make_unique<DeviceCheck>());
  pulse_checks_.push_back(std::make_unique<TemperatureCheck>(
      config.max_temperature_C, config.temperature_tolerance_K, rig.coils, thermal_));
  pulse_checks_.push_back(std::make_unique<DutyCheck>(config.max_duty, config.duty_window_s, rig.coils));
}

void Supervisor::latch(const std::string& reason) {
  coils_.stop();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    reason_ = reason;
  }
  latched_ = true;
  common::log_warning("safety stop: " + reason);
  throw common::HardwareError("safety: " + reason + "; the coils are off, find the cause and start again");
}

void Supervisor::refuse_if_stopped() {
  if (latched())
    throw common::HardwareError("safety: stopped earlier (" + reason() + "); no pulse until a restart");
  std::string requested;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    requested = requested_;
  }
  if (!requested.empty()) latch(requested);
}

/// What a check distrusts stops the coils for good, and so does a device that fails while it is asked.
template <class Action>
void Supervisor::guarded(const Action& action) {
  refuse_if_stopped();
  try {
    action();
  } catch (const std::exception& error) {
    latch(error.what());
  }
}

void Supervisor::request_stop(const std::string& reason) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (requested_.empty()) requested_ = reason;
  }
  coils_.stop();
}

void Supervisor::check_cause_is_gone() {
  operator_.check();
  keep_out_->look();
  rig::CoilPulse nothing;
  PulseContext asked = context();
  asked.status = coils_.status();
  reported_ = asked.status;
  last_ = nothing;
  last_s_ = clock_.now_s();
  for (const auto& check : pulse_checks_) check->check(nothing, asked);
}

void Supervisor::rearm() {
  check_cause_is_gone();
  const std::lock_guard<std::mutex> lock(mutex_);
  requested_.clear();
  reason_.clear();
  latched_ = false;
}

std::string Supervisor::reason() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return reason_;
}

void Supervisor::begin_step(double due_s) {
  guarded([&] {
    operator_.check();
    for (const auto& check : step_checks_) check->begin_step(clock_.now_s(), due_s);
  });
}

void Supervisor::observe(const control::PoseEstimate& estimate) {
  guarded([&] {
    needle_seen_.forget();
    if (estimate.fault) throw Distrust(estimate.reason);
    if (!estimate.valid && !estimate.either_way) return;  // its place is known either way
    for (const auto& check : pose_checks_) check->observe(estimate, clock_.now_s());
    needle_seen_.observe(estimate, clock_.now_s());
  });
}

void Supervisor::apply(const rig::CoilPulse& pulse) { give(pulse, /*probe=*/false); }

void Supervisor::probe(const rig::CoilPulse& pulse) { give(pulse, /*probe=*/true); }

/// Time since the last pulse is accounted for.
PulseContext Supervisor::context() {
  PulseContext context;
  context.last = last_;
  context.now_s = clock_.now_s();
  context.passed_s = std::max(0.0, context.now_s - last_s_);
  context.on_s = std::min(last_.duration_s, context.passed_s);
  thermal_.advance(last_.current_A, context.on_s, context.passed_s);
  return context;
}

void Supervisor::give(const rig::CoilPulse& pulse, bool probe) {
  rig::CoilPulse safe = pulse;
  guarded([&] {
    operator_.check();
    PulseContext asked = context();
    if (probe)
      needle_seen_.check_probe(safe);
    else if (needle_required_)
      needle_seen_.check(safe, asked);
    asked.status = coils_.status();
    reported_ = asked.status;
    for (const auto& check : pulse_checks_) check->check(safe, asked);
  });
  if (safe.current_A != pulse.current_A || safe.duration_s != pulse.duration_s) ++limited_;
  last_ = safe;
  last_s_ = clock_.now_s();
  try {
    coils_.apply(safe);
  } catch (const std::exception& error) {
    latch(error.what());
  }
  refuse_if_stopped();  // asked for while the pulse was on its way
}

}  // namespace lodestone::safety
