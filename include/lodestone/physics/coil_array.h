#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/field_table.h"

namespace lodestone::physics {

/// Coil order everywhere: +x, -x, +y, -y.
constexpr int kCoils = 4;
using Currents = std::array<double, kCoils>;

/// Unit vector from the dish centre to a coil.
geometry::Vector2 coil_direction(int coil);

/// A vector of the dish frame seen in the frame whose +x axis points to `coil`, and back.
geometry::Vector2 to_coil_frame(int coil, const geometry::Vector2& vector);
geometry::Vector2 from_coil_frame(int coil, const geometry::Vector2& vector);

/// How a coil differs from the description: its field is `gain` times as strong, and it stands `offset_m`
/// (dish frame) away, turned about its own middle by `tilt_rad` in the dish plane. A tilt out of the plane
/// changes the field in the plane by its square only and is left out.
struct CoilPlacement {
  double gain = 1.0;
  double tilt_rad = 0.0;
  geometry::Vector2 offset_m = geometry::Vector2::Zero();
};

/// Field of four equal coils in the dish plane, from one tabulated coil by rotation.
class CoilArray {
 public:
  /// The coils stand where they should, or, with four placements, near there.
  explicit CoilArray(std::shared_ptr<const FieldTable> table, std::vector<CoilPlacement> placements = {});

  /// Field (T) at a point of the dish frame (m) for four currents (A). Throws LogicFault outside the table.
  geometry::Vector2 field_T(const Currents& current_A, const geometry::Vector2& point_m) const;
  const FieldTable& table() const { return *table_; }

 private:
  geometry::Vector2 displaced_per_ampere(int coil, const geometry::Vector2& point_m) const;

  std::shared_ptr<const FieldTable> table_;
  std::vector<CoilPlacement> placements_;
};

}  // namespace lodestone::physics
