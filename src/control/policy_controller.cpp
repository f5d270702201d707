#include "lodestone/control/policy_controller.h"

#include "lodestone/common/error.h"

namespace lodestone::control {

PolicyController::PolicyController(const nets::Policy& policy)
    : actor_(policy.actor),
      encoder_(policy.encoder),
      input_(torch::zeros({1, encoder_.size()}, torch::kFloat32)) {
  LODESTONE_CHECK(!actor_.is_empty(), "a policy with an actor");
}

geometry::Vector2 PolicyController::act(const task::Observation& observation) {
  // The guard belongs to the thread, so it is set here and not where the policy was loaded.
  const torch::NoGradGuard no_grad;
  encoder_.encode(observation, input_.data_ptr<float>());
  const torch::Tensor output = actor_->forward(input_).to(torch::kFloat64).contiguous();
  LODESTONE_CHECK(output.numel() == 2, "two numbers from the actor");
  const double* values = output.data_ptr<double>();
  const geometry::Vector2 action(values[0], values[1]);
  LODESTONE_CHECK(action.allFinite(), "finite actions from the policy network");
  return action;
}

}  // namespace lodestone::control
