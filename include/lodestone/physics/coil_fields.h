#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coils_description.h"
#include "lodestone/physics/field_table.h"
#include "lodestone/physics/plane_table.h"

namespace lodestone::physics {

/// Fields of a rig's coils over the needle's plane, as the description has them: four equal coils in the
/// plane by rotation of one table, others by a table each, of their windings or of what was measured.
/// Immutable: rigs share one.
class CoilFields {
 public:
  /// Covers the dish and `margin_m` around it, for coils that stand elsewhere than they should. Throws
  /// ConfigError where a winding lies in the dish, or coils were not measured as far.
  CoilFields(const CoilsDescription& coils, double dish_radius_m, double margin_m = 0.0,
             double spacing_m = 1e-3);
  /// Four equal coils.
  explicit CoilFields(std::shared_ptr<const FieldTable> table);

  /// As constructed, or those of the same coils, reach and spacing that somebody still holds: to tabulate
  /// coils that are listed takes a while. From any thread.
  static std::shared_ptr<const CoilFields> shared(const CoilsDescription& coils, double dish_radius_m,
                                                  double margin_m = 0.0, double spacing_m = 1e-3);

  std::size_t coils() const { return middles_m_.size(); }
  /// Whether coils and needle lie in one plane, so that no field leaves it.
  bool planar() const { return ring_ != nullptr; }
  double reach_m() const { return reach_m_; }
  /// Middle of a coil, in the dish frame; what it is turned about.
  const Eigen::Vector3d& middle_m(std::size_t coil) const { return middles_m_[coil]; }
  /// Whether it is the field of these coils.
  bool of(const CoilsDescription& coils) const;

  /// Of planar coils: that of the first.
  const FieldTable& table() const { return *ring_; }
  /// T/A in the plane, of planar coils. Throws LogicFault outside the reach.
  geometry::Vector2 in_plane(std::size_t coil, const geometry::Vector2& point_m) const;
  /// T/A. Throws LogicFault outside the reach.
  Eigen::Vector3d per_ampere(std::size_t coil, const geometry::Vector2& point_m) const;
  /// T, without any current: of measured coils what the magnetometer saw (the earth's, and what cores keep),
  /// else nothing. Throws likewise.
  Eigen::Vector3d background_T(const geometry::Vector2& point_m) const;
  bool has_background() const { return !background_.empty(); }

 private:
  std::shared_ptr<const FieldTable> ring_;
  std::vector<PlaneTable> tables_;
  std::vector<PlaneTable> background_;  // one, or none
  std::vector<CoilDescription> described_;
  MeasuredRegion measured_;
  std::vector<Eigen::Vector3d> middles_m_;
  double reach_m_ = 0.0;
};

}  // namespace lodestone::physics
