#include "lodestone/rig/hidden_deviation.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/random.h"
#include "lodestone/common/range.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::rig {
namespace {

/// Bounds of what is drawn; sources in docs/virtual-rig.md.
struct Ranges {
  common::Range moment;  // factors, uniform in their logarithm
  common::Range friction;
  common::Range viscosity;
  double gain;                        // +-, uniform
  double tilt_rad;                    // +-, uniform
  double position_m;                  // radius of a disc
  double offset_m;                    // radius of a disc
  common::Range weight = {1.0, 1.0};  // factors, likewise
  common::Range map_sigma = {1.0, 1.0};
  common::Range map_correlation = {1.0, 1.0};
};

constexpr Ranges kLab = {{0.9, 1.1}, {0.9, 1.1}, {0.9, 1.1}, 0.03, 1.0 * geometry::kPi / 180.0,
                         0.5e-3,     0.5e-3};
constexpr Ranges kWide = {{0.75, 1.6}, {0.6, 1.6}, {0.7, 1.4}, 0.08, 3.0 * geometry::kPi / 180.0,
                          2e-3,        1.5e-3};
constexpr Ranges kFar = {{0.75, 1.6}, {0.6, 1.6}, {0.7, 1.4}, 0.08,       8.0 * geometry::kPi / 180.0,
                         5e-3,        1.5e-3,     {0.7, 1.3}, {0.5, 1.5}, {0.5, 2.0}};

const Ranges& ranges(DeviationWidth width) {
  if (width == DeviationWidth::kFar) return kFar;
  return width == DeviationWidth::kWide ? kWide : kLab;
}

double draw_factor(const common::Range& range, common::RandomStream& random) {
  return std::exp(random.uniform(std::log(range.low), std::log(range.high)));
}

geometry::Vector2 draw_in_disc(double radius_m, common::RandomStream& random) {
  const double r = radius_m * std::sqrt(random.uniform());
  const double angle = random.uniform(-geometry::kPi, geometry::kPi);
  return {r * std::cos(angle), r * std::sin(angle)};
}

}  // namespace

HiddenDeviation HiddenDeviation::draw(DeviationWidth width, std::uint64_t seed,
                                      const physics::CoilsDescription& coils) {
  HiddenDeviation hidden;
  if (width == DeviationWidth::kNone) return hidden;
  const Ranges& of = ranges(width);
  common::RandomStream random(seed, "hidden deviation");
  hidden.moment = draw_factor(of.moment, random);
  hidden.friction = draw_factor(of.friction, random);
  hidden.viscosity = draw_factor(of.viscosity, random);
  const geometry::Vector2 offset_m = draw_in_disc(of.offset_m, random);
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    physics::CoilPlacement placement;
    placement.gain = 1.0 + random.uniform(-of.gain, of.gain);
    placement.tilt_rad = random.uniform(-of.tilt_rad, of.tilt_rad);
    placement.offset_m = offset_m + draw_in_disc(of.position_m, random);
    if (coils.coil(coil).measured()) {
      placement.tilt_rad = 0.0;
      placement.offset_m = offset_m;
    }
    hidden.coils.push_back(placement);
  }
  hidden.weight = draw_factor(of.weight, random);
  hidden.map_sigma = draw_factor(of.map_sigma, random);
  hidden.map_correlation = draw_factor(of.map_correlation, random);
  return hidden;
}

physics::RigDescription HiddenDeviation::applied_to(physics::RigDescription rig) const {
  rig.needle.moment_A_m2 *= moment;
  rig.friction.static_coefficient *= friction;
  rig.friction.kinetic_coefficient *= friction;
  rig.friction.rolling_arm_m *= friction;
  rig.friction.map_sigma *= map_sigma;
  rig.friction.map_correlation_m *= map_correlation;
  rig.fluid.viscosity_Pa_s *= viscosity;
  for (double* of_weight : {&rig.needle.mass_kg, &rig.needle.net_weight_N, &rig.needle.inertia_kg_m2})
    *of_weight *= weight;
  return rig;
}

double deviation_margin_m(DeviationWidth width, const physics::RigDescription& rig) {
  if (width == DeviationWidth::kNone) return 0.0;
  const Ranges& of = ranges(width);
  double margin_m = of.offset_m;
  for (std::size_t coil = 0; coil < rig.coils.count(); ++coil) {
    const physics::CoilDescription one = rig.coils.coil(coil);
    if (one.measured()) continue;
    const double lever_m = one.middle_m().head<2>().norm() + rig.dish.radius_m;
    margin_m = std::max(margin_m, of.position_m + of.offset_m + of.tilt_rad * lever_m);
  }
  return margin_m;
}

}  // namespace lodestone::rig
