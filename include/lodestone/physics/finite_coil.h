#pragma once

#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_geometry.h"

namespace lodestone::physics {

/// Vacuum permeability (CODATA 2018), T m / A.
constexpr double kVacuumPermeability = 1.25663706212e-6;

/// Field components along the axis of a loop or coil, and away from it.
struct AxialRadial {
  double axial = 0.0;
  double radial = 0.0;
};

/// Complete elliptic integrals K(m) and E(m) of parameter m = k^2 in [0, 1), by the arithmetic-geometric
/// mean.
struct EllipticKE {
  double k;
  double e;
};
EllipticKE complete_elliptic(double m);

/// Field (T/A) of a circular loop of `radius_m` at (axial_m from its plane, radial_m >= 0 from its axis).
/// Jackson, Classical Electrodynamics, 5.5; Simpson et al., NASA TM-2001-210919.
AxialRadial loop_field_per_ampere(double radius_m, double axial_m, double radial_m);

/// Exact field of a coil of rectangular winding section with uniform turn density: current loops by elliptic
/// integrals, summed by Gauss-Legendre quadrature over the section. Positive current makes a field along
/// +axis.
class FiniteCoil {
 public:
  /// The orders hold 1e-6 of the field over the whole dish for the default winding (checked by a test).
  explicit FiniteCoil(const CoilGeometry& geometry, int radial_order = 8, int axial_order = 20);
  /// One that may stand anywhere.
  explicit FiniteCoil(const CoilWinding& winding, int radial_order = 8, int axial_order = 20);

  /// T/A at (axial_m from the middle of the winding, radial_m >= 0 from its axis). Not for points in the
  /// winding.
  AxialRadial per_ampere(double axial_m, double radial_m) const;
  /// In-plane T/A at a point of a frame with the dish centre at the origin and the coil on +x.
  geometry::Vector2 in_dish_plane(const geometry::Vector2& point_m) const;

 private:
  struct Loop {
    double radius_m;
    double axial_m;
    double turns;
  };
  std::vector<Loop> loops_;
  double centre_distance_m_ = 0.0;
};

/// Closed form on the axis, T/A, at `axial_m` from the middle of the winding.
double on_axis_per_ampere(const CoilGeometry& geometry, double axial_m);

}  // namespace lodestone::physics
