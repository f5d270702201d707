#include "lodestone/physics/coil_description.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "lodestone/common/config.h"
#include "lodestone/physics/measured_region.h"

namespace lodestone::physics {

void CoilDescription::validate() const {
  CoilWinding::validate();
  constexpr std::size_t kLongest = 16;
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '_'; };
  if (name.empty() || name.size() > kLongest || !std::all_of(name.begin(), name.end(), plain))
    throw common::InvalidConfig("name", name,
                                "name the coil in 1 to 16 letters, digits, +, - or _, for it heads columns");
  if (position_m.size() != 3) throw common::InvalidConfig("position_m", position_m, "hold [x, y, z]");
  const bool given = !axis.empty();
  if (given && axis.size() != 3) throw common::InvalidConfig("axis", axis, "hold [x, y, z], or nothing");
  if (!(unit_axis().norm() > 0.5)) {
    if (given) throw common::InvalidConfig("axis", axis, "not be 0");
    throw common::InvalidConfig("position_m", position_m, "not be the dish centre, or have an axis");
  }
  if (measured() && !are_harmonics(harmonics_T_per_A.size()))
    throw common::InvalidConfig("harmonics_T_per_A", harmonics_T_per_A.size(),
                                "be 3, 8, 15, 24, ... numbers: harmonics of degree 1, 2, 3, 4, ...");
}

Eigen::Vector3d CoilDescription::unit_axis() const {
  return axis.empty() ? middle_m().normalized() : Eigen::Vector3d(axis[0], axis[1], axis[2]).normalized();
}

bool CoilDescription::winds_at(const Eigen::Vector3d& point_m, double clear_m) const {
  const Eigen::Vector3d from_m = point_m - middle_m();
  const double axial_m = from_m.dot(unit_axis());
  const double radial_m = (from_m - axial_m * unit_axis()).norm();
  return std::abs(axial_m) < 0.5 * length_m + clear_m && radial_m > inner_radius_m - clear_m &&
         radial_m < outer_radius_m + clear_m;
}

}  // namespace lodestone::physics
