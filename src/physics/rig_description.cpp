#include "lodestone/physics/rig_description.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/common/named.h"

namespace lodestone::physics {

namespace {

constexpr double kOfNeedleEnds_m = 0.5e-3;  // beyond the dish

/// Whether a coil's winding reaches into the dish, or closer to the needle's plane there than its field is
/// known.
bool winds_in(const CoilDescription& coil, double dish_radius_m) {
  constexpr double kStep_m = 0.5e-3;  // winding sections are wider, with their clearance
  const double reach_m = dish_radius_m + kOfNeedleEnds_m;
  const auto rings = static_cast<int>(std::ceil(reach_m / kStep_m));
  for (int ring = 0; ring <= rings; ++ring) {
    const double radius_m = reach_m * ring / rings;
    const int turns = 1 + static_cast<int>(2.0 * geometry::kPi * radius_m / kStep_m);
    for (int turn = 0; turn < turns; ++turn) {
      const double angle_rad = 2.0 * geometry::kPi * turn / turns;
      if (coil.winds_at({radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), 0.0},
                        kClearOfWinding_m))
        return true;
    }
  }
  return false;
}

/// Keys of one kind of driver beside the other kind, and a supply that one coil alone would use up.
void check_drivers(const RigDescription& rig) {
  const AmplifierConfig& amplifier = rig.amplifier;
  const bool of_current = amplifier.controls == AmplifierControl::kCurrent;
  const auto must_be_0 = [&](const char* key, auto value) {
    if (value != 0)
      throw common::InvalidConfig(std::string("amplifier.") + key, value,
                                  "be 0 where amplifier.controls is " + common::name_of(amplifier.controls));
  };
  if (of_current) {
    must_be_0("ramp_s", amplifier.ramp_s);
    must_be_0("duty_steps", amplifier.duty_steps);
    must_be_0("resistance_after_s", amplifier.resistance_after_s);
  } else {
    must_be_0("time_constant_s", amplifier.time_constant_s);
  }
  if (rig.supply_resistance_ohm > 0.0 && rig.supply_resistance_ohm * rig.coils.max_current_A >= rig.supply_V)
    throw common::InvalidConfig(
        "supply_resistance_ohm", rig.supply_resistance_ohm,
        fmt::format("be below {} ohm, with which coils.max_current_A would leave nothing of supply_V",
                    rig.supply_V / rig.coils.max_current_A));
}

}  // namespace

common::Json completed_rig(const common::Json& recorded) {
  common::Json whole = common::config_to_json(RigDescription{});
  whole.merge_patch(recorded);
  for (common::Json& coil : whole["coils"]["each"]) {
    common::Json all = common::config_to_json(CoilDescription{});
    all.merge_patch(coil);
    coil = all;
  }
  return whole;
}

std::string other_drive(const common::Json& one, const common::Json& other) {
  for (const char* key : {"kind", "field_numbers"})
    if (one["drive"][key] != other["drive"][key])
      return fmt::format("rig.drive.{} = {}, not {}", key, one["drive"][key].dump(),
                         other["drive"][key].dump());
  return "";
}

void RigDescription::validate() const {
  if (needle.length_m >= 2.0 * dish.radius_m)
    throw common::InvalidConfig("needle.length_m", needle.length_m,
                                fmt::format("be below the dish diameter, {}", 2.0 * dish.radius_m));
  check_drivers(*this);
  if (fluid.depth_m > dish.wall_height_m)
    throw common::InvalidConfig(
        "fluid.depth_m", fluid.depth_m,
        fmt::format("be at most the height of the dish's wall, dish.wall_height_m = {}", dish.wall_height_m));
  if (drive.kind == DriveKind::kOpposedPairs && !coils.each.empty())
    throw common::InvalidConfig(
        "drive.kind", common::name_of(drive.kind),
        fmt::format("be field or independent: opposed_pairs drives +x, -x, +y and -y, and coils.each lists "
                    "{} others",
                    coils.count()));
  if (drive.kind != DriveKind::kField && drive.field_numbers != DriveConfig{}.field_numbers)
    throw common::InvalidConfig("drive.field_numbers", drive.field_numbers,
                                "be left out where drive.kind is " + common::name_of(drive.kind));
  for (std::size_t coil = 0; coil < coils.each.size(); ++coil)
    if (!coils.each[coil].measured() && winds_in(coils.each[coil], dish.radius_m))
      throw common::InvalidConfig(
          fmt::format("coils.each[{}].position_m", coil), coils.each[coil].position_m,
          fmt::format("keep the winding of coil {} out of the dish of {} m (dish.radius_m), and {} m away "
                      "from where the needle moves",
                      coils.each[coil].name, dish.radius_m, kClearOfWinding_m));
  if (coils.any_measured() && coils.measured.disc_radius_m() < dish.radius_m + kOfNeedleEnds_m)
    throw common::InvalidConfig(
        "dish.radius_m", dish.radius_m,
        fmt::format("be at most {:.4f}: {:.1f} mm from the dish centre, less {} m for the needle's ends, is "
                    "as far as the coils were measured in the needle's plane (coils.measured)",
                    std::max(0.0, coils.measured.disc_radius_m() - kOfNeedleEnds_m),
                    1e3 * coils.measured.disc_radius_m(), kOfNeedleEnds_m));
  if (!coils.each.empty()) {
    if (dish.holder_m <= dish.radius_m + dish.wall_thickness_m)
      throw common::InvalidConfig(
          "dish.holder_m", dish.holder_m,
          fmt::format("be beyond the dish and its wall, {}", dish.radius_m + dish.wall_thickness_m));
    return;
  }
  const double face_m = coils.geometry.centre_distance_m - 0.5 * coils.geometry.length_m;
  if (dish.radius_m >= face_m)
    throw common::InvalidConfig(
        "dish.radius_m", dish.radius_m,
        fmt::format("be below the distance of the coils' faces from the dish centre, {}", face_m));
}

int RigDescription::drive_size() const {
  switch (drive.kind) {
    case DriveKind::kIndependent:
      return static_cast<int>(coils.count());
    case DriveKind::kField:
      return static_cast<int>(drive.field_numbers);
    case DriveKind::kOpposedPairs:
      break;
  }
  return 2;
}

CircuitConfig RigDescription::circuit(std::size_t coil) const {
  CircuitConfig circuit;
  circuit.resistance_20C_ohm = coils.resistance_20C_ohm.at(coil);
  circuit.inductance_H = coils.inductance_H.at(coil);
  circuit.supply_V = supply_V;
  circuit.temperature_coefficient_per_K = coils.temperature_coefficient_per_K;
  circuit.heat_capacity_J_per_K = coils.heat_capacity_J_per_K;
  circuit.cooling_W_per_K = coils.cooling_W_per_K;
  circuit.ambient_C = ambient_C;
  return circuit;
}

double RigDescription::reach_m() const {
  if (needle.is_sphere()) return dish.radius_m - 0.5 * needle.diameter_m;
  return std::sqrt(std::pow(dish.radius_m, 2) - std::pow(0.5 * needle.length_m, 2));
}

bool RigDescription::fits(const geometry::Pose2& pose, double beyond_m) const {
  if (needle.is_sphere()) return pose.position_m().norm() < reach_m() + beyond_m;
  const geometry::Vector2 half =
      0.5 * needle.length_m * geometry::Vector2(std::cos(pose.heading_rad), std::sin(pose.heading_rad));
  const double reach_m = dish.radius_m + beyond_m;
  return (pose.position_m() + half).norm() < reach_m && (pose.position_m() - half).norm() < reach_m;
}

}  // namespace lodestone::physics
