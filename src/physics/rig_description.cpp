#include "lodestone/physics/rig_description.h"

#include <cmath>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"

namespace lodestone::physics {
namespace {

std::string text(double value) { return common::Json(value).dump(); }

}  // namespace

void CoilsDescription::validate() const {
  geometry.validate();
  const auto need_four = [](const char* key, std::size_t count) {
    if (count != static_cast<std::size_t>(kCoils))
      throw common::ConfigError(std::string("rig.coils.") + key + " holds " + std::to_string(count) +
                                " numbers, must be four: +x, -x, +y, -y");
  };
  need_four("resistance_20C_ohm", resistance_20C_ohm.size());
  need_four("inductance_H", inductance_H.size());
  need_four("polarity", polarity.size());
  for (const std::int64_t sign : polarity)
    if (sign == 0) throw common::ConfigError("rig.coils.polarity = 0, must be 1 or -1");
}

void RigDescription::validate() const {
  coils.validate();
  needle.validate();
  friction.validate();
  if (needle.length_m >= 2.0 * dish.radius_m)
    throw common::ConfigError("rig.needle.length_m = " + text(needle.length_m) +
                              " must be below the dish diameter, " + text(2.0 * dish.radius_m));
  const double face_m = coils.geometry.centre_distance_m - 0.5 * coils.geometry.length_m;
  if (dish.radius_m >= face_m)
    throw common::ConfigError("rig.dish.radius_m = " + text(dish.radius_m) +
                              " must be below the distance of the coils' faces from the dish centre, " +
                              text(face_m));
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

bool RigDescription::fits(const geometry::Pose2& pose) const {
  const geometry::Vector2 half =
      0.5 * needle.length_m * geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  return (pose.position_m() + half).norm() < dish.radius_m &&
         (pose.position_m() - half).norm() < dish.radius_m;
}

}  // namespace lodestone::physics
