#pragma once

#include <array>
#include <memory>

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

/// Field of four equal coils in the dish plane, from one tabulated coil by rotation.
class CoilArray {
 public:
  explicit CoilArray(std::shared_ptr<const FieldTable> table);

  /// Field (T) at a point of the dish frame (m) for four currents (A). Throws LogicFault outside the table.
  geometry::Vector2 field_T(const Currents& current_A, const geometry::Vector2& point_m) const;
  const FieldTable& table() const { return *table_; }

 private:
  std::shared_ptr<const FieldTable> table_;
};

}  // namespace lodestone::physics
