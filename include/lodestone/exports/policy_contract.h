#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lodestone/inference/policy.h"

namespace lodestone::exports {

/// A row of numbers that an exported policy takes or gives.
struct ContractValue {
  std::string name;                   ///< "pose"
  std::vector<std::string> elements;  ///< with units: "x_m", "y_m", "heading_rad"
  std::string description;

  std::int64_t size() const { return static_cast<std::int64_t>(elements.size()); }
};

/// Where things stand in the row `memory`, which a policy gives and takes again at the next decision. All
/// zero: nothing has been seen or done yet.
struct MemoryLayout {
  static constexpr std::int64_t kKnown = 0;    ///< 1 once a pose has been seen
  static constexpr std::int64_t kPose = 1;     ///< of the last decision: x, y, heading
  static constexpr std::int64_t kAction = 4;   ///< of the last decision, two axes
  static constexpr std::int64_t kPlace = 6;    ///< where pulses have moved nothing: x, y, heading
  static constexpr std::int64_t kStalled = 9;  ///< actions that moved nothing there, the last one first
  static constexpr std::int64_t kStalls = 16;  ///< so many; of the others the oldest is forgotten
};

/// What an action is cut from in inference::Actor::propose().
constexpr float kMostStrength = 1.4142136F;
constexpr float kLeastDirection = 1e-6F;

/// How other programs call a policy, whatever the format: pose, target and what it remembers, in metres and
/// radians, to currents in ampere. `current` is what task::drive_of and physics::opposed_pairs_A make of
/// what control::PolicyController says.
class PolicyContract {
 public:
  /// Throws ConfigError that begins with `what` where nobody knows what its actions are in ampere, and
  /// CheckpointError where the weights do not fit.
  explicit PolicyContract(const inference::Policy& policy, const std::string& what = "policy");

  const inference::Policy& policy() const { return policy_; }
  /// pose, then those that this policy uses of target, target_heading, drive_gain, memory.
  const std::vector<ContractValue>& inputs() const { return inputs_; }
  /// current, and next_memory of those that remember.
  const std::vector<ContractValue>& outputs() const { return outputs_; }
  bool takes(const std::string& input) const;
  bool remembers() const { return memory_size_ > 0; }
  std::int64_t memory_size() const { return memory_size_; }
  /// Current of an action of 1, A.
  double scale_A() const { return scale_A_; }

  /// Array `name` ("l1.weight") of the network, which has so many layers.
  std::vector<float> weights(const std::string& name) const;
  std::size_t layers() const { return policy_.hidden.size() + 1; }
  std::int64_t outputs_of_network() const;

  /// What a user of the file should find in it, as JSON or plain text: contract, task, rig, provenance,
  /// golden (example decisions, policy_golden.h), lodestone (the version).
  std::map<std::string, std::string> metadata() const;

 private:
  inference::Policy policy_;
  std::vector<ContractValue> inputs_, outputs_;
  std::int64_t memory_size_ = 0;
  double scale_A_ = 0.0;
};

}  // namespace lodestone::exports
