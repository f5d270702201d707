#pragma once

#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coil_geometry.h"

namespace lodestone::rig {

/// Index of a coil named "+x", "-x", "+y" or "-y". Throws ConfigError.
int coil_index(const std::string& name);

/// Exact field per ampere of one coil at points of the dish plane, T/A. Throws DataError when a point lies in
/// or beyond the face of the coil's winding, where the field in the plane cannot be measured.
std::vector<geometry::Vector2> field_per_ampere(const physics::CoilGeometry& geometry, int coil,
                                                const std::vector<geometry::Vector2>& points_m);

/// Lines `x_m,y_m,Bx_T_per_A,By_T_per_A` with header, numbers to full precision.
std::string field_csv(const std::vector<geometry::Vector2>& points_m,
                      const std::vector<geometry::Vector2>& field_T_per_A);

/// Image (PNG) of the field over the dish: magnitude in colour, arrows for its direction, the dish, the
/// coil and the points asked for. Throws IoError.
void write_field_plot(const std::string& file, const physics::CoilGeometry& geometry, int coil,
                      double dish_radius_m, const std::vector<geometry::Vector2>& points_m);

}  // namespace lodestone::rig
