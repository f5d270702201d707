#pragma once

#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// A planner that knows what nobody can: where the needle really is, and what pulses really do to it, by a
/// second virtual rig with all that is hidden in the first. Only how the needle happens to lie at a pulse
/// (the scatter of friction) it does not know, and plans for several draws of it. Beside it a planner shows
/// what a wrong model and a wrong pose cost; what both miss is due to search, cost or physics. It belongs to
/// scoring: no real rig can be driven by it, and the check of arrows names it as the one exception.
///
/// With a simulator it goes by what poses cost there, if that was learned, and is limited as that is;
/// without, it goes by distances, up to the rig's largest current. Throws ConfigError where the needle is a
/// sphere.
ControllerSource oracle_source(const DeploymentConfig& config, const SimulatorSource* simulator = nullptr);

/// Lays a twin's needle there, or, where an end would lie in the wall, so much nearer to the centre.
void lay(rig::VirtualRig& twin, geometry::Pose2 pose);

}  // namespace lodestone::experiments
