#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/physics/rig_description.h"

namespace lodestone::rig {

/// How far a virtual rig is from its description: not at all, by what a careful laboratory would not know, or
/// as another rig of the same kind. docs/virtual-rig.md has the ranges with their sources.
enum class DeviationWidth { kNone, kLab, kWide, kFar };
inline std::vector<std::string> names_of(DeviationWidth) { return {"none", "lab", "wide", "far"}; }

/// What nobody knows of a rig: factors on its description, and where its coils stand. Only the virtual rig
/// itself sees them.
struct HiddenDeviation {
  double moment = 1.0;           ///< factor on the needle's moment
  double friction = 1.0;         ///< factor on the mean friction: static, kinetic, rolling
  double viscosity = 1.0;        ///< factor on the fluid's viscosity
  double weight = 1.0;           ///< factor on the needle's mass and net weight
  double map_sigma = 1.0;        ///< factor on how much friction differs over the dish
  double map_correlation = 1.0;  ///< factor on how far it is alike
  /// Where the coils stand relative to where they should, the dish's own offset included; empty: exactly
  /// there.
  std::vector<physics::CoilPlacement> coils;

  /// Draws the deviations of rig `seed`; the same seed always gives the same ones. Coils that were measured
  /// stand where they were measured: their currents and the dish deviate.
  static HiddenDeviation draw(DeviationWidth width, std::uint64_t seed,
                              const physics::CoilsDescription& coils = {});
  /// The rig as it really is, but for the places of its coils.
  physics::RigDescription applied_to(physics::RigDescription rig) const;
};

/// How far beyond the dish the field may be asked for when coils stand elsewhere than they should.
double deviation_margin_m(DeviationWidth width, const physics::RigDescription& rig);

}  // namespace lodestone::rig
