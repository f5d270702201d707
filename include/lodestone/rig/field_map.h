#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/physics/coils_description.h"

namespace lodestone::rig {

/// Index of a coil by its name. Throws ConfigError that lists the names.
std::size_t coil_index(const physics::CoilsDescription& coils, const std::string& name);

/// Field per ampere of one coil at points of the needle's plane, T/A: exact, or as it was measured. Throws
/// DataError when a point lies in its winding, where no field can be measured, or where nobody measured.
std::vector<Eigen::Vector3d> field_per_ampere(const physics::CoilsDescription& coils, std::size_t coil,
                                              const std::vector<geometry::Vector2>& points_m);

/// Lines `x_m,y_m,Bx_T_per_A,By_T_per_A,Bz_T_per_A` with header, numbers to full precision.
std::string field_csv(const std::vector<geometry::Vector2>& points_m,
                      const std::vector<Eigen::Vector3d>& field_T_per_A);

/// Image (PNG) of the field over the dish: magnitude in the plane in colour, arrows for its direction, the
/// dish and the points asked for. Throws IoError.
void write_field_plot(const std::string& file, const physics::CoilsDescription& coils, std::size_t coil,
                      double dish_radius_m, const std::vector<geometry::Vector2>& points_m);

}  // namespace lodestone::rig
