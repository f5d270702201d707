#pragma once

#include <optional>

#include "lodestone/control/controller.h"
#include "lodestone/task/action.h"

namespace lodestone::control {

/// The action for a needle whose axis is seen, and not which end of it is the head: where the controller asks
/// for drives within 30 degrees of each other whichever end it is, the weaker of the two. Nothing where they
/// differ, where either is none, or from a controller that has no clone; the controller takes no note of
/// being asked.
std::optional<geometry::Drive> act_either_way(const Controller& controller,
                                              const task::Observation& observation,
                                              const task::ActionConfig& action);

}  // namespace lodestone::control
