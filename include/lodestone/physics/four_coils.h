#pragma once

#include "lodestone/geometry/pose2.h"

namespace lodestone::physics {

/// The paper's rig: coils +x, -x, +y, -y around the dish, in its plane.
constexpr int kFourCoils = 4;

/// Unit vector from the dish centre to a coil.
geometry::Vector2 coil_direction(int coil);

/// A vector of the dish frame seen in the frame whose +x axis points to `coil`, and back. Exact.
geometry::Vector2 to_coil_frame(int coil, const geometry::Vector2& vector);
geometry::Vector2 from_coil_frame(int coil, const geometry::Vector2& vector);

}  // namespace lodestone::physics
