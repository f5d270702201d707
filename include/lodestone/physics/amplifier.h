#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/physics/amplifier_config.h"
#include "lodestone/physics/coil_circuit.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::physics {

/// What is left of a supply, V, whose inner resistance carries the sum of the currents' magnitudes; 0 at
/// least.
double sagged_V(double supply_V, double resistance_ohm, const PerCoil& current_A);

/// The drivers of all coils, between the currents that are asked for and the voltages on the circuits: skew,
/// ramp, steps, sag of the supply, and drivers that hold a current (AmplifierConfig). Voltages are constant
/// from one change to the next, at most half a millisecond later; a ramp's is the one of the middle, so that
/// no charge is lost. Whoever advances the circuits stops at change_s() and calls change().
///
/// Circuits are as they were at the last change, or at a command: results do not depend on how the time
/// between is cut.
class Amplifier {
 public:
  using Circuits = std::vector<CoilCircuit>;
  static constexpr double kNever_s = std::numeric_limits<double>::infinity();

  /// Of a description that is valid.
  explicit Amplifier(const RigDescription& rig);

  /// Whether anything stands between demand and voltage. False: a demand is a voltage at once
  /// (CoilCircuit::demand), change_s() is never, and there is nothing to save.
  bool shapes() const { return shapes_; }
  /// Whether circuits have to be advanced from change to change, and no shorter.
  bool stepwise() const { return shapes_ && !(external_ && supply_resistance_ohm_ == 0.0); }

  // Commands, at a time up to which the circuits have been advanced.
  /// Currents, A. `until_s`: when they will be switched off, or kNever_s.
  void demand(const PerCoil& current_A, double now_s, double until_s, Circuits& circuits);
  /// As a demand of nothing: motor controllers ramp down, drivers of currents draw them out.
  void off(double now_s, Circuits& circuits);
  /// Power stages that are modelled elsewhere: signed fractions of `supply_V`, which sags under the currents;
  /// nothing else is done to them.
  void drive(const PerCoil& duty, double supply_V, double now_s, Circuits& circuits);

  /// When voltages change next; kNever_s: not before a command.
  double change_s() const { return change_s_; }
  /// They do: now is change_s(), and the circuits have been advanced to it.
  void change(double now_s, Circuits& circuits);

  /// What it is up to, without the circuits' states, and back. restore() throws Json::exception or DataError
  /// where that cannot be, and then leaves it as it was.
  common::Json save() const;
  void restore(const common::Json& state);
  /// Goes on from circuits of which nothing else is known: what drives them now is what was asked for.
  void resume(double now_s, double until_s, Circuits& circuits);

 private:
  struct Output {
    double asked_A = 0.0;       // by the last command,
    double due_s = kNever_s;    // which arrives then; never: it has
    double set_A = 0.0;         // by the last command that has arrived
    double target = 0.0;        // duty for that
    double duty = 0.0;          // on its way there
    double tells_s = kNever_s;  // when the resistance is measured
    double known_ohm = 0.0;     // what duties are set by
    double cold_ohm = 0.0;
  };
  void reset_outputs();
  double step_of(double current_A) const;
  double ramped(const Output& output, double for_s) const;
  void aim(Output& output, double volt, double now_s) const;
  void follow(std::size_t coil, double now_s, const Circuits& circuits);
  double next_change_s(const Circuits& circuits) const;
  void hold_duties(Circuits& circuits) const;
  void hold_currents(Circuits& circuits) const;

  AmplifierConfig config_;
  double supply_V_;
  double supply_resistance_ohm_;
  bool shapes_;
  std::vector<Output> outputs_;
  bool external_ = false;  // driven by drive()
  PerCoil driven_;         // then: duties
  double driven_V_ = 0.0;
  double at_s_ = 0.0;  // of the last change or command
  double change_s_ = kNever_s;
  double until_s_ = kNever_s;
};

}  // namespace lodestone::physics
