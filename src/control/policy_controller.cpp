#include "lodestone/control/policy_controller.h"

#include <algorithm>
#include <array>

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

geometry::Vector2 PolicyController::act(const task::Observation& observation) {
  if (before_) stalls_.repeats({*before_, observation.last_action, observation.pose});
  before_ = observation.pose;
  encoder_.encode(observation, input_.data());
  const std::vector<std::array<float, 2>> ranked = actor_.ranked(input_.data(), workspace_);
  const auto action = [](const std::array<float, 2>& numbers) {
    return geometry::Vector2(numbers[0], numbers[1]);
  };
  LODESTONE_CHECK(action(ranked.front()).allFinite(), "finite actions from the policy network");
  if (ranked.size() == 1 || action(ranked.front()).isZero(0.0)) return action(ranked.front());
  for (const std::array<float, 2>& numbers : ranked)
    if (!action(numbers).isZero(0.0) && !stalls_.stalls(observation.pose, action(numbers)))
      return action(numbers);
  stalls_.reset();
  return action(ranked.front());
}

}  // namespace lodestone::control
