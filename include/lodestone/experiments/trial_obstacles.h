#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/zone.h"
#include "lodestone/physics/obstacles.h"
#include "lodestone/rig/rig_config.h"

namespace lodestone::experiments {

struct TrialPlan;

/// Solid discs that every trial has of its own.
struct TrialObstaclesConfig {
  std::int64_t count = 0;
  double diameter_m = 0.006;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field(
        "count", count, "",
        "so many solid discs are drawn over the dish for each trial of `point` or `pose` on a virtual rig, "
        "clear of start and target; controllers and supervisor are told of them as zones to keep out of; "
        "0: none",
        {0, 100});
    v.field("diameter_m", diameter_m, "m", "of each disc", {2e-4, 0.1});
  }
};

/// Throws ConfigError, naming the key, where obstacles are asked for that a task or a rig cannot have: they
/// are for points and poses, and stand in the dish of a virtual rig with a needle.
void check_obstacles(const TrialObstaclesConfig& config, const rig::RigConfig& rig, const std::string& task);

/// Discs anywhere in the dish, which may overlap. The needle at the plan's start, as it lies there, and at
/// its target, whichever way it lies, keeps further from each than the plan's margin and `clearance_m` (m)
/// together. Throws ConfigError where no such place is found.
std::vector<physics::ObstacleConfig> draw_obstacles(const TrialObstaclesConfig& config,
                                                    const rig::RigConfig& rig, const TrialPlan& plan,
                                                    double clearance_m, common::RandomStream random);

/// What keeps a needle out of a disc.
geometry::Zone zone_of(const physics::ObstacleConfig& disc, const std::string& name);

}  // namespace lodestone::experiments
