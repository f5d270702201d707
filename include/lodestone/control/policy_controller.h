#pragma once

#include "lodestone/control/controller.h"
#include "lodestone/nets/policy.h"

namespace lodestone::control {

/// A trained policy behind the same encoder as in training. Controllers made from copies of one policy share
/// its weights, which are only read, so each thread may have its own.
class PolicyController final : public Controller {
 public:
  explicit PolicyController(const nets::Policy& policy);
  void reset() override {}
  /// Throws LogicFault when the network answers with something that is not a finite number.
  geometry::Vector2 act(const task::Observation& observation) override;

 private:
  nets::Actor actor_;
  task::ObservationEncoder encoder_;
  torch::Tensor input_;  // [1, D] float32
};

}  // namespace lodestone::control
