#include "lodestone/control/policy_controller.h"

#include "lodestone/common/error.h"

namespace lodestone::control {

PolicyController::PolicyController(const inference::Policy& policy)
    : actor_(policy.actor()), encoder_(policy.encoder), input_(static_cast<std::size_t>(encoder_.size())) {}

geometry::Vector2 PolicyController::act(const task::Observation& observation) {
  encoder_.encode(observation, input_.data());
  float output[2];
  actor_.act(input_.data(), 1, output, workspace_);
  const geometry::Vector2 action(output[0], output[1]);
  LODESTONE_CHECK(action.allFinite(), "finite actions from the policy network");
  return action;
}

}  // namespace lodestone::control
