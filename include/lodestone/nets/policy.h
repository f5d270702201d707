#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/config.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"

namespace lodestone::nets {

/// Actor of section IV-B2: D -> hidden (ReLU) -> 2, tanh.
class ActorImpl : public torch::nn::Module {
 public:
  ActorImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
            std::int64_t action_size = 2);
  /// [N, D] -> [N, 2] in [-1, 1].
  torch::Tensor forward(const torch::Tensor& observation);

 private:
  std::vector<torch::nn::Linear> layers_;  // registered as l1, l2, l3, ... as in the reference implementation
};
TORCH_MODULE(Actor);

/// Twin critic: first critic l1..l3, second critic l4..l6, each (D + 2) -> hidden (ReLU) -> 1.
class TwinCriticImpl : public torch::nn::Module {
 public:
  TwinCriticImpl(std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
                 std::int64_t action_size = 2);
  /// [N, D], [N, 2] -> two [N, 1].
  std::pair<torch::Tensor, torch::Tensor> forward(const torch::Tensor& observation,
                                                  const torch::Tensor& action);
  /// First critic alone, [N, 1].
  torch::Tensor first(const torch::Tensor& observation, const torch::Tensor& action);

 private:
  std::vector<torch::nn::Linear> first_;
  std::vector<torch::nn::Linear> second_;
};
TORCH_MODULE(TwinCritic);

/// A deployable policy: actor, and how to encode what it sees and decode what it says.
struct Policy {
  Actor actor{nullptr};
  std::vector<std::int64_t> hidden = {256, 256};
  task::EncoderConfig encoder;
  task::ActionConfig action;
  std::string goal = "point";          ///< task it was trained for
  std::optional<task::Region> region;  ///< that its starts and goals lay in; none: the whole discs
  /// The rig it was trained for, as RigDescription writes it; null where that is not known.
  common::Json rig;
  /// Figures of the run that made it ("collect", "dynamics", "policy"), which deploy repeats beside its own.
  common::Json provenance = common::Json::object();
};

/// Checkpoint of kind "policy" with example inputs and outputs, which load_policy recomputes (within 1e-5).
void save_policy(const std::string& folder, const Policy& policy, const common::Json& run_config,
                 const common::Json& metrics);
/// Writes Policy::provenance into a policy checkpoint that is there.
void set_policy_provenance(const std::string& folder, const common::Json& provenance);
/// Throws CheckpointError.
Policy load_policy(const std::string& folder);

}  // namespace lodestone::nets
