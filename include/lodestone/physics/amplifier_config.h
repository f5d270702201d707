#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lodestone::physics {

/// What a driver holds on its coil: a fraction of the supply's voltage, or a current.
enum class AmplifierControl { kDuty, kCurrent };
inline std::vector<std::string> names_of(AmplifierControl) { return {"duty", "current"}; }

/// How the drivers of the coils answer a demand. By default they follow at once, with duties that are right
/// for coils of 20 C.
struct AmplifierConfig {
  AmplifierControl controls = AmplifierControl::kDuty;
  double ramp_s = 0.0;
  std::int64_t duty_steps = 0;
  double resistance_after_s = 0.0;
  double time_constant_s = 0.0;
  double current_step_A = 0.0;
  double axis_skew_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("controls", controls, "",
            "duty: the drivers hold a fraction of the supply, and a warm coil gets less current; current: "
            "they hold the current, as far as the supply can push it");
    v.field("ramp_s", ramp_s, "s", "of duty: how long it takes from nothing to the whole supply; 0: at once",
            {0.0, 10.0});
    v.field("duty_steps", duty_steps, "",
            "of duty: steps from nothing to the whole supply, rounded towards nothing; 0: any duty",
            {0.0, 1e6});
    v.field("resistance_after_s", resistance_after_s, "s",
            "of duty: once steady for so long, with 1 A at least, it tells the coil's resistance, which sets "
            "duties from there on; 0: resistances are taken to be those of 20 C",
            {0.0, 10.0});
    v.field("time_constant_s", time_constant_s, "s",
            "of current: time constant with which it follows where the supply allows; 0: as fast as the "
            "supply allows",
            {0.0, 1.0});
    v.field("current_step_A", current_step_A, "A", "currents are asked for in steps of this; 0: any current",
            {0.0, 10.0});
    v.field("axis_skew_s", axis_skew_s, "s",
            "drivers of two coils each are told what changes one after another, so much apart: coils 3 and 4 "
            "after coils 1 and 2, and so on",
            {0.0, 0.1});
  }
  /// Whether a demand is a voltage at once, and nothing else.
  bool ideal() const {
    return controls == AmplifierControl::kDuty && ramp_s == 0.0 && duty_steps == 0 &&
           resistance_after_s == 0.0 && current_step_A == 0.0 && axis_skew_s == 0.0;
  }
};

}  // namespace lodestone::physics
