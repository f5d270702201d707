#pragma once

#include <cstdint>
#include <memory>

#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// A needle that lies still is lifted by hand and put down 30 mm from there: looks of the simulated localiser
/// until the tracker says where it is, the most of `count` tries.
std::int64_t looks_until_found(const DeploymentConfig& config, std::int64_t count);

/// What the coils did while nothing was seen.
struct BlindDrive {
  std::int64_t pulses = 0;
  double most_A = 0.0;
};

/// The baseline drives a virtual rig to a point; from its tenth step on nothing is seen for `steps` steps.
BlindDrive drive_blind(const DeploymentConfig& config, std::int64_t steps, std::uint64_t seed);

/// What became of a needle that was hidden while something else was seen.
struct DistractedDrive {
  std::int64_t taken = 0;  ///< poses that were not the needle's
  bool found = false;      ///< it was, after it was to be seen again
};

/// The baseline drives a virtual rig to a point; from its tenth step on the needle is not seen for `steps`
/// steps, but three scratches like it somewhere in the dish are, and from then on all of them.
DistractedDrive drive_distracted(const DeploymentConfig& config, std::int64_t steps, std::uint64_t seed);

/// Least RMS spread (m) of the track of a needle that lies still, one image a period, for so long.
double least_spread_m(const DeploymentConfig& config, double lies_s);

/// Time of the tracker alone, for a pulse and a look; with an identifier, what a learned simulator says of
/// the pulse included.
double tracker_ms(const DeploymentConfig& config, std::int64_t steps,
                  const std::shared_ptr<control::RigIdentifier>& identifier = nullptr);

}  // namespace lodestone::experiments
