#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::experiments {

constexpr const char* kStuckOutput = "output stuck at a duty";
constexpr const char* kWeldedContactor = "contactor welded";

/// Faults that no program can survive together, and why.
struct ExcludedFaults {
  const char* one;
  const char* other;
  const char* why;
};
constexpr ExcludedFaults kExcludedFaults[] = {
    {kStuckOutput, kWeldedContactor, "nothing is left that could switch the coil off"}};

/// Every fault that can be injected into a bench; names as the reports print them.
std::vector<std::string> fault_names();

/// What became of one fault injected in the middle of a pulse.
struct FaultResult {
  std::string fault;          ///< or two, "one + other"
  double injected_s = 0.0;    ///< on the bench's clock
  bool stopped = false;       ///< the run ended; otherwise it was tolerated
  std::string reason;         ///< as the run's log has it; for a fault tolerated, how it shows
  double on_after_s = 0.0;    ///< how long any coil still carried current without a break
  bool unsafe = false;        ///< a bound was broken: `reason` says which
  std::int64_t pulses = 0;    ///< that reached the coils
  std::int64_t asked = 0;     ///< that the run asked for and was told of as given
  std::int64_t recorded = 0;  ///< steps that the record holds on disk
  std::int64_t steps = 0;     ///< steps that the run took
  std::optional<bool> held;   ///< in a pulse of seconds (inject_held_fault)

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("fault", fault);
    v.field("injected_s", injected_s);
    v.field("stopped", stopped);
    v.field("reason", reason);
    v.field("on_after_s", on_after_s);
    v.field("unsafe", unsafe);
    v.field("steps", steps);
    v.field("recorded", recorded);
    v.field("held", held);
  }
};

/// A fault must leave all coils without current within this time.
constexpr double kOffWithin_s = 0.6;

/// Runs the whole chain (control loop, supervisor, serial coils, firmware, motor controllers, virtual rig) in
/// simulated time and is injected once, in the middle of a pulse. `folder` takes the record. Throws
/// HardwareError when there is no emulator, LogicFault for a name that is none.
FaultResult inject_fault(const std::string& fault, std::uint64_t seed, const std::string& folder);

/// The faults of the list that concern line, firmware, motor controllers or coils.
std::vector<std::string> device_fault_names();

/// The same in the middle of a pulse that would last for seconds, so that only what notices the fault can end
/// it: the PC looks at the status every 50 ms and stops on the first fault.
FaultResult inject_held_fault(const std::string& fault, std::uint64_t seed, const std::string& folder);

/// A long run with many faults.
struct HourReport {
  std::vector<FaultResult> faults;
  std::int64_t pulses = 0;
  double simulated_s = 0.0;
  std::int64_t unsafe = 0;
  double longest_on_s = 0.0;  ///< longest stretch with current in any coil
  double largest_current_A = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("pulses", pulses);
    v.field("simulated_s", simulated_s);
    v.field("largest_current_A", largest_current_A);
    v.field("faults", faults);
  }
};

/// Many pulses with one random fault a minute; after every stop an operator removes the fault, clears the
/// latch and goes on.
HourReport inject_for_an_hour(std::int64_t pulses, std::uint64_t seed, const std::string& folder);

/// Bench time with two random faults at the same moment of every minute, all but kExcludedFaults.
HourReport inject_pairs(double duration_s, std::uint64_t seed, const std::string& folder);

}  // namespace lodestone::experiments
