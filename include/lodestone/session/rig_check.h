#pragma once

#include <cstdint>
#include <string>

#include "lodestone/rig/rig_config.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/sensing.h"

namespace lodestone::session {

/// A bench, as the verbs around its wiring use it; keys are those of deploy and collect.
struct RigCheckConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 1;
  double test_current_A = 3.0;
  std::int64_t pulses = 5;
  rig::RigConfig rig;
  safety::SafetyConfig safety;
  SensingConfig sensor;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of an emulated bench", {0, 9e15});
    v.field("threads", threads, "", "not used", {0, 1024});
    v.field("test_current_A", test_current_A, "A", "current of the test pulses", {1.0, 10.0});
    v.field("pulses", pulses, "", "pulses per coil of calibrate coils", {1, 100});
    v.group("rig", rig, "the rig");
    v.group("safety", safety, "limits of the supervisor");
    v.group("sensor", sensor, "how poses are sensed");
  }
  void validate() const { rig.validate(); }
};

/// Whom a walk through the wiring talks to.
class Dialogue {
 public:
  virtual ~Dialogue() = default;
  /// Shows text as it is, at once.
  virtual void say(const std::string& text) = 0;
  /// Whether to go on with what the question says; false where nobody answers.
  virtual bool confirm(const std::string& question) = 0;
  /// Whether a person stands at the rig, who can press its switch and look at the needle.
  virtual bool attended() const = 0;
};

/// What is done besides the walk itself.
struct RigCheckRequest {
  bool camera = true;
  bool clear = false;  ///< forget the faults that the coil controller has latched
};

/// Walks through the wiring of the bench on the serial port: firmware, supply, emergency stop, camera, the
/// current of each coil, which coil answers to which name. Throws HardwareError where the bench is not ready.
void check_rig(const RigCheckConfig& config, const RigCheckRequest& request, Dialogue& dialogue);

}  // namespace lodestone::session
