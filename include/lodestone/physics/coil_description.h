#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lodestone/physics/coil_geometry.h"

namespace lodestone::physics {

constexpr double kClearOfWinding_m = 1e-3;  ///< nearer to it the field is none of a coil seen from outside

/// One coil of a rig: its winding, and where in space it stands; or, where it was measured, what a
/// magnetometer saw of it.
struct CoilDescription : CoilWinding {
  std::string name;
  std::vector<double> position_m;  ///< [3]: the middle of the winding in the dish frame; z is up
  std::vector<double> axis;        ///< [3]: the field on the axis for positive current; empty: outwards
  double gain = 1.0;               ///< of its field over that of the winding, as a magnetometer tells
  std::vector<double> harmonics_T_per_A;  ///< about CoilsDescription::measured; empty: the winding's field
  double max_current_A = 0.0;             ///< 0: as the rig's
  bool bipolar = false;                   ///< takes currents of either sign
  std::vector<std::string> not_with;      ///< coils that are never on together with it

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name, "", "what messages and records call it");
    v.field("position_m", position_m, "m",
            "[x, y, z] of the middle of the winding from the middle of the needle's plane; z is up",
            {-1.0, 1.0});
    v.field("axis", axis, "",
            "[x, y, z], of any length: along the field on the axis for positive current; []: from the dish "
            "to the coil",
            {-1e3, 1e3});
    CoilWinding::visit(v);
    v.field("gain", gain, "",
            "its field over that of the winding as described (turns that were miscounted, an ammeter that is "
            "off), as calibrate field finds it",
            {0.1, 10.0});
    v.field("harmonics_T_per_A", harmonics_T_per_A, "T/A",
            "gradients of solid harmonics that are its field, as calibrate field writes them for coils with "
            "cores: about coils.measured, which says where they hold; the winding is then for pictures only; "
            "[]: the field of the winding",
            {-1e12, 1e12});
    v.field("max_current_A", max_current_A, "A", "largest current; 0: coils.max_current_A", {0.0, 1000.0});
    v.field("bipolar", bipolar, "", "whether its driver gives currents of either sign");
    v.field("not_with", not_with, "", "names of coils that must be off while this one is on");
  }
  /// Throws ConfigError when name, position or axis is missing or no vector.
  void validate() const;

  /// Whether its field is what a magnetometer saw.
  bool measured() const { return !harmonics_T_per_A.empty(); }
  Eigen::Vector3d middle_m() const { return Eigen::Vector3d(position_m[0], position_m[1], position_m[2]); }
  Eigen::Vector3d unit_axis() const;
  /// Whether a point of the dish frame lies in the winding, or nearer to it than `clear_m`.
  bool winds_at(const Eigen::Vector3d& point_m, double clear_m = 0.0) const;
};

}  // namespace lodestone::physics
