#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/physics/coil_array.h"
#include "lodestone/physics/coil_circuit.h"
#include "lodestone/physics/coil_geometry.h"
#include "lodestone/physics/friction_map.h"
#include "lodestone/physics/needle.h"
#include "lodestone/physics/needle_motion.h"

namespace lodestone::physics {

/// Four equal air-core coils and what drives them. Figures and their sources: the design notes on the rig.
struct CoilsDescription {
  CoilGeometry geometry;
  std::vector<double> resistance_20C_ohm = {1.90, 1.90, 1.90, 1.90};        // D: 560 turns of AWG16
  std::vector<double> inductance_H = {17.6e-3, 17.6e-3, 17.6e-3, 17.6e-3};  // D: L/R = 9.3 ms
  std::vector<std::int64_t> polarity = {1, 1, 1, 1};
  double max_current_A = 15.0;                    // Q: the paper's rig
  double temperature_coefficient_per_K = 3.9e-3;  // I: copper
  double heat_capacity_J_per_K = 651.0;           // I: mass of copper
  double cooling_W_per_K = 15.0;                  // D: thermal time constant about 45 s

  template <class Visitor>
  void visit(Visitor& v) {
    geometry.visit(v);
    v.field("resistance_20C_ohm", resistance_20C_ohm, "ohm", "at 20 C, of the coils +x, -x, +y, -y",
            {1e-3, 1e4});
    v.field("inductance_H", inductance_H, "H", "of the coils +x, -x, +y, -y", {1e-9, 10.0});
    v.field("polarity", polarity, "",
            "1 where a positive current makes a field towards the coil, -1 where it is wired the other way "
            "round",
            {-1.0, 1.0});
    v.field("max_current_A", max_current_A, "A", "largest current of a coil: what an action of 1 means",
            {0.0, 1000.0});
    v.field("temperature_coefficient_per_K", temperature_coefficient_per_K, "1/K",
            "relative change of resistance", {0.0, 0.02});
    v.field("heat_capacity_J_per_K", heat_capacity_J_per_K, "J/K", "heat capacity of a coil", {0.1, 1e6});
    v.field("cooling_W_per_K", cooling_W_per_K, "W/K", "heat lost per degree above ambient", {0.0, 1e4});
  }
  /// Throws ConfigError when a list does not hold four numbers or a polarity is 0.
  void validate() const;
};

/// What a laboratory knows about its rig: `rig.json`, the only place where these figures stand.
struct RigDescription {
  CoilsDescription coils;
  double supply_V = 34.0;   // D
  double ambient_C = 22.0;  // D
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
    v.group("coils", coils, "the four coils");
    v.field("supply_V", supply_V, "V", "supply that the drivers switch", {0.1, 1000.0});
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

  /// Electrical and thermal side of one coil.
  CircuitConfig circuit(int coil) const;
  /// Pull that just moves the needle where friction is at its mean, N.
  double breakaway_N() const { return friction.static_coefficient * needle.net_weight_N; }
  /// Whether both ends of the needle lie inside the wall, or no further than `beyond_m` outside.
  bool fits(const geometry::Pose2& pose, double beyond_m = 0.0) const;
};

}  // namespace lodestone::physics
