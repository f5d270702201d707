#include "lodestone/physics/amplifier.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::physics {
namespace {

constexpr double kLongestHold_s = 0.5e-3;        // of voltages
constexpr double kSoon_s = 1e-9;                 // what is due within this is due now
constexpr double kGone_A = 1e-6;                 // a driver of currents lets go of less
constexpr double kTelling_A = 1.0;               // less tells no resistance
constexpr std::size_t kOutputsOfController = 2;  // coils of a motor controller

PerCoil currents_A(const Amplifier::Circuits& circuits) {
  PerCoil current_A(circuits.size());
  for (std::size_t i = 0; i < circuits.size(); ++i) current_A[i] = circuits[i].state().current_A;
  return current_A;
}

common::Json time_to_json(double time_s) {
  return std::isfinite(time_s) ? common::Json(time_s) : common::Json();
}
double time_from_json(const common::Json& json) {
  return json.is_null() ? Amplifier::kNever_s : json.get<double>();
}

}  // namespace

double sagged_V(double supply_V, double resistance_ohm, const PerCoil& current_A) {
  double sum_A = 0.0;
  for (const double current : current_A) sum_A += std::abs(current);
  return std::max(0.0, supply_V - resistance_ohm * sum_A);
}

Amplifier::Amplifier(const RigDescription& rig)
    : config_(rig.amplifier),
      supply_V_(rig.supply_V),
      supply_resistance_ohm_(rig.supply_resistance_ohm),
      shapes_(!rig.amplifier.ideal() || rig.supply_resistance_ohm > 0.0),
      outputs_(rig.coils.count()) {
  for (std::size_t coil = 0; coil < outputs_.size(); ++coil) {
    outputs_[coil].cold_ohm = rig.coils.resistance_20C_ohm.at(coil);
    outputs_[coil].known_ohm = outputs_[coil].cold_ohm;
  }
}

/// All off; what is known of the coils stays.
void Amplifier::reset_outputs() {
  for (Output& output : outputs_) {
    const double known_ohm = output.known_ohm;
    const double cold_ohm = output.cold_ohm;
    output = Output{};
    output.known_ohm = known_ohm;
    output.cold_ohm = cold_ohm;
  }
}

double Amplifier::step_of(double current_A) const {
  const double step_A = config_.current_step_A;
  return step_A > 0.0 ? step_A * std::round(current_A / step_A) : current_A;
}

void Amplifier::demand(const PerCoil& current_A, double now_s, double until_s, Circuits& circuits) {
  if (!shapes_) {
    for (std::size_t i = 0; i < circuits.size(); ++i) circuits[i].demand(current_A[i]);
    return;
  }
  external_ = false;
  driven_ = PerCoil();
  until_s_ = until_s;
  double due_s = now_s;
  for (std::size_t first = 0; first < outputs_.size(); first += kOutputsOfController) {
    const std::size_t end = std::min(first + kOutputsOfController, outputs_.size());
    bool differs = false;
    for (std::size_t i = first; i < end; ++i) {
      const double asked_A = step_of(current_A[i]);
      differs = differs || asked_A != outputs_[i].asked_A;
      outputs_[i].asked_A = asked_A;
    }
    if (!differs) continue;  // a controller of which nothing new is asked is told nothing
    for (std::size_t i = first; i < end; ++i) outputs_[i].due_s = due_s;
    due_s += config_.axis_skew_s;
  }
  change(now_s, circuits);
}

void Amplifier::off(double now_s, Circuits& circuits) {
  if (shapes_) return demand(PerCoil(), now_s, kNever_s, circuits);
  for (CoilCircuit& circuit : circuits) circuit.off();
}

void Amplifier::drive(const PerCoil& duty, double supply_V, double now_s, Circuits& circuits) {
  if (!shapes_) {
    for (std::size_t i = 0; i < circuits.size(); ++i) circuits[i].drive(duty[i], supply_V);
    return;
  }
  external_ = true;
  driven_ = duty;
  driven_V_ = supply_V;
  until_s_ = kNever_s;
  reset_outputs();
  change(now_s, circuits);
}

void Amplifier::change(double now_s, Circuits& circuits) {
  if (!shapes_) return;
  for (std::size_t coil = 0; coil < outputs_.size(); ++coil) follow(coil, now_s, circuits);
  at_s_ = now_s;
  change_s_ = next_change_s(circuits);
  if (external_ || config_.controls == AmplifierControl::kDuty) {
    hold_duties(circuits);
  } else {
    hold_currents(circuits);
  }
}

/// The duty so much later.
double Amplifier::ramped(const Output& output, double for_s) const {
  const double missing = output.target - output.duty;
  if (std::abs(missing) * config_.ramp_s <= for_s + kSoon_s) return output.target;
  return output.duty + std::copysign(for_s / config_.ramp_s, missing);
}

/// At the duty for the current that is set, of a supply of so many volt.
void Amplifier::aim(Output& output, double volt, double now_s) const {
  output.tells_s = kNever_s;
  if (config_.controls == AmplifierControl::kCurrent) return;
  output.target = volt > 0.0 ? geometry::saturated(output.set_A * output.known_ohm / volt) : 0.0;
  if (config_.duty_steps > 0) {
    const auto steps = static_cast<double>(config_.duty_steps);
    output.target = std::trunc(output.target * steps) / steps;
  }
  if (config_.ramp_s == 0.0) output.duty = output.target;
  if (config_.resistance_after_s > 0.0 && std::abs(output.set_A) >= kTelling_A)
    output.tells_s =
        now_s + std::abs(output.target - output.duty) * config_.ramp_s + config_.resistance_after_s;
}

/// Up to now: the ramp, a command that arrives, a resistance that is told.
void Amplifier::follow(std::size_t coil, double now_s, const Circuits& circuits) {
  Output& output = outputs_[coil];
  output.duty = ramped(output, now_s - at_s_);
  if (output.due_s <= now_s + kSoon_s) {
    output.due_s = kNever_s;
    output.set_A = output.asked_A;
    aim(output, supply_V_, now_s);
  } else if (output.tells_s <= now_s + kSoon_s) {
    // The supply is measured with it: one that has sagged is no hot coil.
    const double volt = sagged_V(supply_V_, supply_resistance_ohm_, currents_A(circuits));
    const double current_A = std::abs(circuits[coil].state().current_A);
    if (current_A > kGone_A)
      output.known_ohm =
          std::clamp(std::abs(output.duty) * volt / current_A, 0.5 * output.cold_ohm, 2.0 * output.cold_ohm);
    aim(output, volt, now_s);
  }
}

double Amplifier::next_change_s(const Circuits& circuits) const {
  if (external_ && supply_resistance_ohm_ == 0.0) return kNever_s;
  bool active = false;
  double next_s = at_s_ + kLongestHold_s;
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const Output& output = outputs_[i];
    const bool held = config_.controls == AmplifierControl::kCurrent && !external_ &&
                      (output.set_A != 0.0 || std::abs(circuits[i].state().current_A) > kGone_A);
    const bool on = output.target != 0.0 || output.duty != 0.0 || driven_[i] != 0.0;
    active = active || held || on || output.due_s < kNever_s;
    next_s = std::min({next_s, output.due_s, output.tells_s});
    if (output.target != output.duty)
      next_s = std::min(next_s, at_s_ + std::abs(output.target - output.duty) * config_.ramp_s);
  }
  if (!active) return kNever_s;
  next_s = std::max(next_s, at_s_ + kSoon_s);
  // The end of a pulse is a change, too; without this a last one might be due a rounding error before it.
  if (until_s_ > at_s_ + kSoon_s && until_s_ < next_s + kSoon_s) next_s = until_s_;
  return next_s;
}

/// Duties and the supply's voltage are those of the middle of what comes.
void Amplifier::hold_duties(Circuits& circuits) const {
  const double middle_s = change_s_ == kNever_s ? 0.0 : 0.5 * (change_s_ - at_s_);
  PerCoil duty(circuits.size());
  for (std::size_t i = 0; i < circuits.size(); ++i)
    duty[i] = external_ ? driven_[i] : ramped(outputs_[i], middle_s);
  const double source_V = external_ ? driven_V_ : supply_V_;
  const auto put = [&](const PerCoil& current_A) {
    const double volt = sagged_V(source_V, supply_resistance_ohm_, current_A);
    for (std::size_t i = 0; i < circuits.size(); ++i) circuits[i].drive(duty[i], volt);
  };
  put(currents_A(circuits));
  if (supply_resistance_ohm_ == 0.0) return;
  PerCoil later_A(circuits.size());
  for (std::size_t i = 0; i < circuits.size(); ++i) later_A[i] = circuits[i].current_after_A(middle_s);
  put(later_A);
}

/// The voltage that leads to the wanted current at the end of what comes, or as much as there is.
void Amplifier::hold_currents(Circuits& circuits) const {
  if (change_s_ == kNever_s) {
    for (CoilCircuit& circuit : circuits) circuit.off();
    return;
  }
  const double step_s = change_s_ - at_s_;
  const double left = config_.time_constant_s > 0.0 ? std::exp(-step_s / config_.time_constant_s) : 0.0;
  const double volt = sagged_V(supply_V_, supply_resistance_ohm_, currents_A(circuits));
  for (std::size_t i = 0; i < circuits.size(); ++i) {
    CoilCircuit& circuit = circuits[i];
    const double now_A = circuit.state().current_A;
    const double wanted_A = outputs_[i].set_A + (now_A - outputs_[i].set_A) * left;
    const double risen = -std::expm1(-step_s / circuit.time_constant_s());
    const double settled_A = now_A + (wanted_A - now_A) / risen;
    circuit.drive(volt > 0.0 ? geometry::saturated(settled_A * circuit.resistance_ohm() / volt) : 0.0, volt);
  }
}

common::Json Amplifier::save() const {
  common::Json state;
  state["external"] = external_;
  state["driven"] = driven_.list();
  state["driven_V"] = driven_V_;
  state["at_s"] = at_s_;
  state["change_s"] = time_to_json(change_s_);
  state["until_s"] = time_to_json(until_s_);
  state["outputs"] = common::Json::array();
  for (const Output& output : outputs_) {
    common::Json of = common::Json::array();
    of.push_back(output.asked_A);
    of.push_back(time_to_json(output.due_s));
    of.push_back(output.set_A);
    of.push_back(output.target);
    of.push_back(output.duty);
    of.push_back(time_to_json(output.tells_s));
    of.push_back(output.known_ohm);
    state["outputs"].push_back(of);
  }
  return state;
}

void Amplifier::restore(const common::Json& state) {
  Amplifier restored = *this;
  const common::Json& outputs = state.at("outputs");
  const auto driven = state.at("driven").get<std::vector<double>>();
  if (outputs.size() != outputs_.size() || driven.size() > outputs_.size())
    throw common::DataError("amplifier state: " + std::to_string(outputs.size()) + " outputs, this rig has " +
                            std::to_string(outputs_.size()) + " coils");
  restored.external_ = state.at("external").get<bool>();
  restored.driven_ = PerCoil(driven);
  restored.driven_V_ = state.at("driven_V").get<double>();
  restored.at_s_ = state.at("at_s").get<double>();
  restored.change_s_ = time_from_json(state.at("change_s"));
  restored.until_s_ = time_from_json(state.at("until_s"));
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const common::Json& of = outputs.at(i);
    Output& output = restored.outputs_[i];
    output.asked_A = of.at(0).get<double>();
    output.due_s = time_from_json(of.at(1));
    output.set_A = of.at(2).get<double>();
    output.target = of.at(3).get<double>();
    output.duty = of.at(4).get<double>();
    output.tells_s = time_from_json(of.at(5));
    output.known_ohm = of.at(6).get<double>();
  }
  *this = std::move(restored);
}

void Amplifier::resume(double now_s, double until_s, Circuits& circuits) {
  if (!shapes_) return;
  external_ = false;
  driven_ = PerCoil();
  until_s_ = until_s;
  at_s_ = now_s;
  reset_outputs();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    Output& output = outputs_[i];
    const double duty = circuits[i].state().duty;
    output.known_ohm = output.cold_ohm;
    output.set_A = duty * supply_V_ / output.cold_ohm;
    output.asked_A = output.set_A;
    if (config_.controls == AmplifierControl::kDuty) output.target = output.duty = duty;
  }
  change(now_s, circuits);
}

}  // namespace lodestone::physics
