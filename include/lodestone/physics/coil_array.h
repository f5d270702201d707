#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_fields.h"
#include "lodestone/physics/per_coil.h"

namespace lodestone::physics {

/// How a coil differs from the description: its field is `gain` times as strong, and it stands `offset_m`
/// (dish frame) away, turned about the vertical through its own middle by `tilt_rad`. A tilt out of the plane
/// is left out: of coils in the plane it changes the field there by its square only.
struct CoilPlacement {
  double gain = 1.0;
  double tilt_rad = 0.0;
  geometry::Vector2 offset_m = geometry::Vector2::Zero();
};

/// Field of a rig's coils in the needle's plane.
class CoilArray {
 public:
  /// The coils stand where they should, or, with a placement for each, near there.
  explicit CoilArray(std::shared_ptr<const CoilFields> fields, std::vector<CoilPlacement> placements = {});
  /// Four equal coils.
  explicit CoilArray(std::shared_ptr<const FieldTable> table, std::vector<CoilPlacement> placements = {});

  /// Field (T) in the plane at a point of the dish frame (m), with what is there without current. Throws
  /// LogicFault outside the tables.
  geometry::Vector2 field_T(const PerCoil& current_A, const geometry::Vector2& point_m) const;
  /// With what points out of the plane.
  Eigen::Vector3d spatial_field_T(const PerCoil& current_A, const geometry::Vector2& point_m) const;
  /// Whether nothing ever points out of it.
  bool planar() const { return fields_->planar(); }

 private:
  Eigen::Vector3d per_ampere(std::size_t coil, const geometry::Vector2& point_m) const;

  std::shared_ptr<const CoilFields> fields_;
  std::vector<CoilPlacement> placements_;
};

}  // namespace lodestone::physics
