#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment.h"
#include "lodestone/geometry/keep_out.h"
#include "lodestone/inference/policy.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/task/route_map.h"

namespace lodestone::experiments {

/// Pulses in a learned simulator: config.route.simulated_pulses from every cell of the dish, with places in
/// it, headings and drives drawn from config.seed. Those that would leave the dish are left out. Throws
/// ConfigError where the simulator predicts single values.
std::vector<task::Move> simulated_moves(const DeploymentConfig& config, const SimulatorSource& simulator);

/// The ways in the dish, by the best that is known of it: pulses that the simulator was trained on, or that
/// are driven in it; else the region that the policy was trained in; else the whole dish. Either may be null.
/// Nothing where config.route says that no ways are searched. Throws ConfigError where config.route asks for
/// what is not there.
std::shared_ptr<const task::RouteMap> route_map(const DeploymentConfig& config,
                                                const SimulatorSource* simulator,
                                                const inference::Policy* policy);

/// Throws ConfigError, naming `what` and the zone, where a needle whose middle goes straight from one place
/// to another comes within the margin of a zone, however it lies.
void check_keeps_out(const geometry::KeepOut& keep_out, const geometry::Vector2& from_m,
                     const geometry::Vector2& to_m, const std::string& what);

/// A map as it is written beside the trials.
runs::ReachMap reach_map_of(const task::RouteMap& map);

}  // namespace lodestone::experiments
