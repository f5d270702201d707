#include "lodestone/control/policy_controller.h"

#include <algorithm>

#include "lodestone/common/error.h"

namespace lodestone::control {
PolicyController::PolicyController(const inference::Policy& policy)
    : actor_(policy.actor()),
      encoder_(policy.encoder),
      input_(static_cast<std::size_t>(encoder_.size())),
      stalls_(kStill_m, kStill_rad) {}

void PolicyController::reset() {
  stalls_.reset();
  before_.reset();
}

geometry::Drive PolicyController::act(const task::Observation& observation) {
  if (before_) stalls_.repeats({*before_, observation.last_action, observation.pose});
  before_ = observation.pose;
  encoder_.encode(observation, input_.data());
  const std::vector<geometry::Drive> ranked = actor_.ranked(input_.data(), workspace_);
  LODESTONE_CHECK(ranked.front().allFinite(), "finite actions from the policy network");
  if (ranked.size() == 1 || ranked.front().isZero(0.0)) return ranked.front();
  for (const geometry::Drive& action : ranked)
    if (!action.isZero(0.0) && !stalls_.stalls(observation.pose, action)) return action;
  stalls_.reset();
  return ranked.front();
}

}  // namespace lodestone::control
