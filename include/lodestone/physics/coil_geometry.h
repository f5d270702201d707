#pragma once

#include <cstdint>

namespace lodestone::physics {

/// Winding of an air-core coil. Figures and their sources: the design notes on the rig ("Q" read in a source,
/// "S" second-hand, "I" computed, "D" chosen here).
struct CoilWinding {
  double inner_radius_m = 0.033;  // D: inner diameter 66 mm, self-consistent with 560 turns of AWG16
  double outer_radius_m = 0.049;  // S: outer diameter 98 mm
  double length_m = 0.060;        // S
  std::int64_t turns = 560;       // D: the published 648 turns do not fit their own window

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("inner_radius_m", inner_radius_m, "m", "inner radius of the winding", {1e-3, 0.5});
    v.field("outer_radius_m", outer_radius_m, "m", "outer radius of the winding", {1e-3, 0.5});
    v.field("length_m", length_m, "m", "length of the winding along its axis", {1e-3, 0.5});
    v.field("turns", turns, "", "turns of wire", {1, 100000});
  }
  /// Throws ConfigError when the radii are in the wrong order.
  void validate() const;

  bool operator==(const CoilWinding& other) const {
    return inner_radius_m == other.inner_radius_m && outer_radius_m == other.outer_radius_m &&
           length_m == other.length_m && turns == other.turns;
  }
};

/// Winding of one of four equal coils in the dish plane, and where it stands.
struct CoilGeometry : CoilWinding {
  double centre_distance_m = 0.080;  // S: coil centre to dish centre; the face is then at 50 mm

  template <class Visitor>
  void visit(Visitor& v) {
    CoilWinding::visit(v);
    v.field("centre_distance_m", centre_distance_m, "m", "from the dish centre to the middle of the winding",
            {5e-3, 1.0});
  }
  /// Throws ConfigError when the radii are in the wrong order or the winding reaches the dish centre.
  void validate() const;

  bool operator==(const CoilGeometry& other) const {
    return CoilWinding::operator==(other) && centre_distance_m == other.centre_distance_m;
  }
};

/// Winding as published for a re-implementation of the rig (648 turns, inner diameter 85 mm): for
/// comparisons.
CoilGeometry published_coil_geometry();

}  // namespace lodestone::physics
