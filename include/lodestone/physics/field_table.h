#pragma once

#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_geometry.h"

namespace lodestone::physics {

/// The exact in-plane field of the +x coil, tabulated once over the dish plane and interpolated by a bicubic
/// B-spline (twice continuously differentiable, so forces have no steps). Immutable: rigs share one.
class FieldTable {
 public:
  /// Covers |x|, |y| <= reach_m as far as the winding leaves room: beside it the field of the nearest free
  /// point towards the dish centre stands. Throws ConfigError when the winding begins within `free_m`, the
  /// part of the reach that must be free of it; 0: all of it.
  FieldTable(const CoilGeometry& geometry, double reach_m, double spacing_m = 1e-3, double free_m = 0.0);

  /// T/A at a point of the frame with the coil on +x. Throws LogicFault outside the reach.
  geometry::Vector2 per_ampere(const geometry::Vector2& point_m) const;

  const CoilGeometry& geometry() const { return geometry_; }
  double reach_m() const { return reach_m_; }

 private:
  CoilGeometry geometry_;
  double reach_m_;
  double spacing_m_;
  double origin_x_m_ = 0.0;  // of coefficient (0, 0)
  double origin_y_m_ = 0.0;
  int rows_ = 0;     // along x
  int columns_ = 0;  // along y; only y >= 0 and its stencil are kept, the rest follows by symmetry
  std::vector<double> coefficients_;  // [rows, columns, 2]
};

/// Table over a dish of the given radius with a margin for the needle's ends, which must be free of winding,
/// and a further one for coils that stand elsewhere than they should.
std::shared_ptr<const FieldTable> make_field_table(const CoilGeometry& geometry, double dish_radius_m,
                                                   double margin_m = 0.0, double spacing_m = 1e-3);

}  // namespace lodestone::physics
