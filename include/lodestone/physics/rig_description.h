#pragma once

#include <cstddef>

#include "lodestone/common/json.h"
#include "lodestone/physics/amplifier_config.h"
#include "lodestone/physics/coil_circuit.h"
#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/drive_config.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle.h"
#include "lodestone/physics/needle_motion.h"

namespace lodestone::physics {

/// What a laboratory knows about its rig: `rig.json`, the only place where these figures stand.
struct RigDescription {
  CoilsDescription coils;
  DriveConfig drive;
  AmplifierConfig amplifier;
  double supply_V = 34.0;              // D
  double supply_resistance_ohm = 0.0;  // D
  double ambient_C = 22.0;             // D
  double full_drive_A = 0.0;
  NeedleConfig needle;
  DishConfig dish;
  FluidConfig fluid;
  FrictionConfig friction;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("coil", "coils, which holds the winding, too");
    v.retired("circuit", "coils.resistance_20C_ohm, coils.inductance_H and the like, supply_V and ambient_C");
    v.retired("max_current_A", "coils.max_current_A");
    v.group("coils", coils, "the coils");
    v.group("drive", drive, "what an action means for the coils");
    v.group("amplifier", amplifier, "how the drivers of the coils answer a demand");
    v.field("supply_V", supply_V, "V", "supply that the drivers switch", {0.1, 1000.0});
    v.field("supply_resistance_ohm", supply_resistance_ohm, "ohm",
            "of the supply and its wires: the voltage sags by this times the sum of the currents' magnitudes",
            {0.0, 100.0});
    v.field("ambient_C", ambient_C, "C", "room temperature; coils start there", {-20.0, 60.0});
    v.field("full_drive_A", full_drive_A, "A",
            "current at 100 per cent of drive, for recordings and policies that count in per cent; 0: not "
            "known",
            {0.0, 1000.0});
    v.group("needle", needle, "the needle");
    v.group("dish", dish, "the dish");
    v.group("fluid", fluid, "the fluid");
    v.group("friction", friction, "friction on the dish");
  }
  /// Throws ConfigError when parts do not fit together.
  void validate() const;

  /// Numbers of an action: what drives the coils.
  int drive_size() const;
  /// Electrical and thermal side of one coil.
  CircuitConfig circuit(std::size_t coil) const;
  /// Pull that just moves the needle where friction is at its mean, N.
  double breakaway_N() const { return friction.static_coefficient * needle.net_weight_N; }
  /// How far from the dish centre the needle's middle can come: furthest out, it lies along the wall.
  double reach_m() const;
  /// Whether both ends of the needle lie inside the wall, or no further than `beyond_m` outside.
  bool fits(const geometry::Pose2& pose, double beyond_m = 0.0) const;
};

/// A description as a recording or a policy carries it, of this version or an earlier one: keys that were not
/// known then stand as they are by default.
common::Json completed_rig(const common::Json& recorded);

/// Where the numbers of an action mean something else for the coils of two completed descriptions: what the
/// first says, and the second, as in `rig.drive.kind = "field", not "opposed_pairs"`. Empty where they do
/// not.
std::string other_drive(const common::Json& one, const common::Json& other);

}  // namespace lodestone::physics
