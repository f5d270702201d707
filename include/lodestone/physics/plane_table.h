#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

/// A field in space, tabulated once over the needle's plane and interpolated by a bicubic B-spline (twice
/// continuously differentiable, so forces have no steps). Immutable: rigs share one.
class PlaneTable {
 public:
  /// Calls `field` at points of the plane with |x|, |y| up to a few spacings beyond `reach_m`.
  PlaneTable(const std::function<Eigen::Vector3d(const geometry::Vector2&)>& field, double reach_m,
             double spacing_m);

  /// Throws LogicFault outside the reach.
  Eigen::Vector3d at(const geometry::Vector2& point_m) const;

 private:
  double reach_m_;
  double spacing_m_;
  double origin_m_;  // of coefficient (0, 0), along both axes
  int side_;
  std::vector<double> coefficients_;  // [side, side, 3]
};

}  // namespace lodestone::physics
