#include "lodestone/physics/rig_description.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodestone/common/config.h"

namespace lodestone::physics {

void CoilsDescription::validate() const {
  geometry.validate();  // its keys are among these
  const auto need_four = [](const char* key, const auto& list) {
    if (list.size() != static_cast<std::size_t>(kCoils))
      throw common::InvalidConfig(key, list, "hold four numbers: +x, -x, +y, -y");
  };
  need_four("resistance_20C_ohm", resistance_20C_ohm);
  need_four("inductance_H", inductance_H);
  need_four("polarity", polarity);
  if (std::count(polarity.begin(), polarity.end(), 0) > 0)
    throw common::InvalidConfig("polarity", polarity, "hold 1 or -1 for each coil");
}

void RigDescription::validate() const {
  if (needle.length_m >= 2.0 * dish.radius_m)
    throw common::InvalidConfig("needle.length_m", needle.length_m,
                                fmt::format("be below the dish diameter, {}", 2.0 * dish.radius_m));
  const double face_m = coils.geometry.centre_distance_m - 0.5 * coils.geometry.length_m;
  if (dish.radius_m >= face_m)
    throw common::InvalidConfig(
        "dish.radius_m", dish.radius_m,
        fmt::format("be below the distance of the coils' faces from the dish centre, {}", face_m));
}

CircuitConfig RigDescription::circuit(int coil) const {
  const auto index = static_cast<std::size_t>(coil);
  CircuitConfig circuit;
  circuit.resistance_20C_ohm = coils.resistance_20C_ohm.at(index);
  circuit.inductance_H = coils.inductance_H.at(index);
  circuit.supply_V = supply_V;
  circuit.temperature_coefficient_per_K = coils.temperature_coefficient_per_K;
  circuit.heat_capacity_J_per_K = coils.heat_capacity_J_per_K;
  circuit.cooling_W_per_K = coils.cooling_W_per_K;
  circuit.ambient_C = ambient_C;
  return circuit;
}

bool RigDescription::fits(const geometry::Pose2& pose, double beyond_m) const {
  const geometry::Vector2 half =
      0.5 * needle.length_m * geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const double reach_m = dish.radius_m + beyond_m;
  return (pose.position_m() + half).norm() < reach_m && (pose.position_m() - half).norm() < reach_m;
}

}  // namespace lodestone::physics
