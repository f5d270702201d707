#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/pose_sensor.h"
#include "lodestone/rig/coils.h"

namespace lodestone::tests {

/// Time that only sleeping moves.
class ManualClock final : public common::Clock {
 public:
  double now_s() const override { return now_s_; }
  bool wait_until(double time_s, common::Interruption* interruption) override {
    if (interruption != nullptr && interruption->raised()) return false;
    now_s_ = time_s > now_s_ ? time_s : now_s_;
    return true;
  }

 private:
  double now_s_ = 100.0;
};

/// Coils that remember what they were asked and fail on demand.
class RecordingCoils final : public rig::Coils {
 public:
  void apply(const rig::CoilPulse& pulse) override {
    if (fail_at >= 0 && static_cast<int>(pulses.size()) == fail_at) throw common::HardwareError("no answer");
    pulses.push_back(pulse);
    on = true;
  }
  void stop() noexcept override {
    ++stops;
    on = false;
  }
  rig::CoilStatus status() override {
    if (silent) throw common::HardwareError("no answer");
    return state;
  }

  std::vector<rig::CoilPulse> pulses;
  rig::CoilStatus state;
  int fail_at = -1;
  int stops = 0;
  bool on = false;
  bool silent = false;
};

/// Sensor that replays a list of estimates and then repeats the last.
class ScriptedSensor final : public control::PoseSensor {
 public:
  explicit ScriptedSensor(const common::Clock& clock) : clock_(clock) {}
  control::PoseEstimate observe() override {
    if (throws) throw common::HardwareError("camera unplugged");
    control::PoseEstimate next = script.at(0);
    if (script.size() > 1) script.pop_front();
    if (!stalled) stamp_s_ = clock_.now_s();
    next.stamp_s = stamp_s_;
    return next;
  }
  void pulsed(const physics::PerCoil&, const std::vector<physics::PulseOutcome>&) override { ++pulses; }
  void pulse_cut() override { ++cut; }
  void push(double x_m, double y_m, double heading_rad = 0.0) {
    script.push_back({true, "", {x_m, y_m, heading_rad}, false, 0.0, 0.0, 0.0, false, {}});
  }
  void push_invalid(const std::string& reason) {
    script.push_back({false, reason, {}, false, 0.0, 0.0, 0.0, false, {}});
  }

  void push_either_way(double x_m, double y_m, double heading_rad) {
    script.push_back({false, "no tape", {x_m, y_m, heading_rad}, true, 0.0, 0.0, 0.0, false, {}});
  }

  void forget() override { ++forgotten; }

  std::deque<control::PoseEstimate> script;
  int forgotten = 0;
  int pulses = 0;  ///< that it was told of,
  int cut = 0;     ///< and how many of them were cut short
  bool throws = false;
  bool stalled = false;  ///< the same image for ever

 private:
  const common::Clock& clock_;
  double stamp_s_ = 0.0;
};

/// Controller made of a function; keeps what it saw.
class FunctionController final : public control::Controller {
 public:
  explicit FunctionController(std::function<geometry::Drive(const task::Observation&)> function)
      : function_(std::move(function)) {}
  void reset() override { seen.clear(); }
  geometry::Drive act(const task::Observation& observation) override {
    seen.push_back(observation);
    return function_(observation);
  }
  std::vector<task::Observation> seen;

 private:
  std::function<geometry::Drive(const task::Observation&)> function_;
};

inline geometry::Drive nan_action() { return {std::numeric_limits<double>::quiet_NaN(), 0.0}; }

}  // namespace lodestone::tests
