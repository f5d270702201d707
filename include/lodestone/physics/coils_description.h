#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/physics/coil_description.h"
#include "lodestone/physics/coil_geometry.h"
#include "lodestone/physics/measured_region.h"

namespace lodestone::physics {

/// The coils and what drives them: four equal ones around the dish, in its plane, or each as it is listed.
/// Figures and their sources: the design notes on the rig.
struct CoilsDescription {
  CoilGeometry geometry;
  std::vector<CoilDescription> each;  ///< 1 to 16; empty: +x, -x, +y, -y of the geometry above
  MeasuredRegion measured;            ///< where those hold whose field is what a magnetometer saw
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
    v.list("each", each, plain_coil(),
           "the coils one by one: name, position_m, axis, inner_radius_m, outer_radius_m, length_m, turns, "
           "gain, harmonics_T_per_A, max_current_A, bipolar, not_with; what one does not say of its winding "
           "is as above; []: four "
           "of these, +x, -x, +y and -y, at centre_distance_m");
    v.group("measured", measured, "where coils were measured that have harmonics_T_per_A");
    v.field("resistance_20C_ohm", resistance_20C_ohm, "ohm",
            "at 20 C, of each coil in the order in which they are listed (+x, -x, +y, -y)", {1e-3, 1e4});
    v.field("inductance_H", inductance_H, "H", "of each coil, likewise", {1e-9, 10.0});
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
  /// Throws ConfigError when a list does not hold a number for each coil, a polarity is 0, or a coil is
  /// listed twice, or was measured nobody says where.
  void validate() const;

  std::size_t count() const;
  /// As listed, or one of the four.
  CoilDescription coil(std::size_t coil) const;
  /// Largest current of a coil, A, and smallest: below 0 where it takes either sign.
  double largest_A(std::size_t coil) const;
  double smallest_A(std::size_t coil) const;
  /// What messages call a coil; its number beyond the last.
  std::string name(std::size_t coil) const;
  /// Whether the field of any coil is what a magnetometer saw.
  bool any_measured() const;
  /// Coils of which only one may be on.
  bool apart(std::size_t one, std::size_t other) const;

 private:
  /// What a listed coil is where it says nothing.
  CoilDescription plain_coil() const;
};

}  // namespace lodestone::physics
