#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodestone/control/controller.h"
#include "lodestone/control/stall_memory.h"
#include "lodestone/inference/policy.h"

namespace lodestone::control {

/// A trained policy behind the same encoder as in training. Of one that proposes several pulses the best is
/// given that is not like one which has moved nothing from where the needle lies: friction stays with the
/// place, and the network remembers one pulse only. When all of them have stalled they are tried anew.
class PolicyController final : public Controller {
 public:
  /// A needle that came less far than this has not moved; a camera errs by less.
  static constexpr double kStill_m = 3e-4;
  static constexpr double kStill_rad = 0.05;

  /// Throws CheckpointError when the weights do not fit the policy's encoder.
  explicit PolicyController(const inference::Policy& policy);
  void reset() override;
  /// Throws LogicFault when the network answers with something that is not a finite number.
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override { return std::make_unique<PolicyController>(*this); }

 private:
  inference::Actor actor_;
  task::ObservationEncoder encoder_;
  std::vector<float> input_;
  inference::Actor::Workspace workspace_;
  StallMemory stalls_;  // drives in units of the largest
  std::optional<geometry::Pose2> before_;
};

}  // namespace lodestone::control
