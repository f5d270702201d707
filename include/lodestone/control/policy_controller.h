#pragma once

#include <vector>

#include "lodestone/control/controller.h"
#include "lodestone/inference/policy.h"

namespace lodestone::control {

/// A trained policy behind the same encoder as in training.
class PolicyController final : public Controller {
 public:
  /// Throws CheckpointError when the weights do not fit the policy's encoder.
  explicit PolicyController(const inference::Policy& policy);
  void reset() override {}
  /// Throws LogicFault when the network answers with something that is not a finite number.
  geometry::Vector2 act(const task::Observation& observation) override;

 private:
  inference::Actor actor_;
  task::ObservationEncoder encoder_;
  std::vector<float> input_;
  inference::Actor::Workspace workspace_;
};

}  // namespace lodestone::control
