#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/config.h"
#include "lodestone/common/random.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/physics/flow.h"
#include "lodestone/physics/obstacles.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rig/coils.h"
#include "lodestone/rig/hidden_deviation.h"

namespace lodestone::rig {

/// How the virtual rig stands in for a real one.
struct SimulationConfig {
  DeviationWidth deviation = DeviationWidth::kLab;
  double max_pulse_s = 10.0;         // D: the driver refuses to hold longer
  double max_temperature_C = 120.0;  // D: reported as a fault above
  double step_s = 0.5e-3;            // D: longest integration step; see the convergence test
  double core_share = 0.0;           // D: the coils have no cores, or none that saturate
  double core_saturation_A = 5.0;    // D
  physics::FlowConfig flow;          // D: the fluid rests
  std::vector<physics::ObstacleConfig> obstacles;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "deviation", deviation, "",
        "how far the virtual rig is from its description: not at all, by what a careful laboratory would not "
        "know, as another rig of the same kind, or further than that");
    v.field("max_pulse_s", max_pulse_s, "s", "longest pulse the drivers accept", {1e-3, 3600.0});
    v.field("max_temperature_C", max_temperature_C, "C",
            "coil temperature above which status() reports a fault", {0.0, 300.0});
    v.field("step_s", step_s, "s", "longest integration step", {1e-6, 5e-3});
    v.field("core_share", core_share, "",
            "share of the coils' field, at small currents, that cores make which saturate; no description "
            "tells of it; 0: none do",
            {0.0, 1.0});
    v.field("core_saturation_A", core_saturation_A, "A",
            "current at which such a core gives 76 % (tanh 1) of what it would, had it not begun to saturate",
            {1e-3, 1000.0});
    v.group("flow", flow, "how the fluid moves; no description tells of it");
    v.list(
        "obstacles", obstacles, physics::ObstacleConfig{},
        "solid bodies in the dish, of which no description tells: shape (disc or polygon) with centre_m and "
        "radius_m, or corners_m; the needle meets them as it meets the wall");
  }
};

/// A rig and how it is simulated.
struct VirtualRigConfig : physics::RigDescription {
  SimulationConfig simulation;

  template <class Visitor>
  void visit(Visitor& v) {
    RigDescription::visit(v);
    v.group("simulation", simulation, "the virtual rig that stands in for this one");
  }
  /// Throws ConfigError when parts of the description do not fit together, or an obstacle is none or not in
  /// the dish.
  void validate() const;
};

/// Stands in for the real rig: its coils, a needle in a dish, and a clock that advances the physics when
/// slept on. What the description does not say is drawn from the seed: the friction map, the scatter from
/// pulse to pulse, and how far the rig is from its description (HiddenDeviation). Fluid that moves goes by
/// the rig's clock. Safe to use from any thread: who looks or stops waits at most until a stretch of constant
/// current has been computed.
class VirtualRig {
 public:
  /// `fields`: shared with other rigs of the same coils and dish; made here when null. The needle lies at the
  /// centre along +x, or as place() would lay it there. Throws ConfigError, also when obstacles leave no
  /// place for it; LogicFault when the fields are of other coils or too small.
  VirtualRig(const VirtualRigConfig& config, std::uint64_t seed,
             std::shared_ptr<const physics::CoilFields> fields = nullptr);
  ~VirtualRig();
  VirtualRig(const VirtualRig&) = delete;
  VirtualRig& operator=(const VirtualRig&) = delete;

  Coils& coils();
  /// Simulated time: sleep_until() advances the physics and returns at once.
  common::Clock& clock();
  /// From here on simulated time passes as fast as on this clock, in small pieces, so that another thread
  /// sees the needle move. What happens is bitwise the same. `wall` must outlive the rig.
  void keep_pace_with(common::Clock& wall);

  /// What a power stage of its own puts on the coils from now on, instead of pulses: signed fractions of
  /// `supply_V`. Of the description's drivers only the sag of the supply is added: ramps, steps and skew are
  /// the power stage's own.
  void drive(const physics::PerCoil& duty, double supply_V);

  /// The operator places the needle, at rest: where an obstacle is in the way at the nearest free place
  /// (physics::NeedleMotion::free_near). Throws DataError when an end would lie outside the wall.
  void place(const geometry::Pose2& pose);
  /// Whether the needle lies wholly inside the wall at this pose. Of obstacles it does not tell.
  bool fits(const geometry::Pose2& pose) const;

  /// Where the needle really is. For scoring and for the simulated pose sensor only: controllers and training
  /// never see it.
  geometry::Pose2 true_pose() const;
  /// Whether the needle is at rest, held by friction. For scoring and tests, as true_pose().
  bool at_rest() const;

  const VirtualRigConfig& config() const;
  /// To be shared with further rigs.
  std::shared_ptr<const physics::CoilFields> fields() const;

  /// Everything that changes (needle, currents, drivers, temperatures, time, random stream), and back,
  /// bitwise; the friction map comes from the seed. A state that says nothing of the drivers goes on with
  /// what drives the coils. restore() throws DataError when the state is malformed or of another seed.
  common::Json save() const;
  void restore(const common::Json& state);

 private:
  class VirtualCoils;
  class VirtualClock;
  struct State;

  bool advance_to(double time_s, common::Interruption* interruption);
  bool run(double duration_s, std::unique_lock<std::mutex>& lock, common::Interruption* interruption);
  bool pace(std::unique_lock<std::mutex>& lock, common::Interruption* interruption);

  std::unique_ptr<State> state_;
};

}  // namespace lodestone::rig
