#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/inference/actor_critic.h"
#include "lodestone/inference/cost_to_go.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"

namespace lodestone::inference {

/// A deployable policy: actor, and how to encode what it sees and decode what it says.
struct Policy {
  Arrays weights;  ///< of the actor: "l1.weight", ...
  std::vector<std::int64_t> hidden = {256, 256};
  std::int64_t proposals = 0;  ///< see Actor
  task::EncoderConfig encoder;
  task::ActionConfig action;
  std::string goal = "point";          ///< task it was trained for
  std::optional<CostToGo> cost_to_go;  ///< that a planner may go by, where one was learned with it
  std::optional<task::Region> region;  ///< that its starts and goals lay in; none: the whole discs
  /// The rig it was trained for, as RigDescription writes it; null where that is not known.
  common::Json rig;
  /// Figures of the run that made it ("collect", "dynamics", "policy"), which deploy repeats beside its own.
  common::Json provenance = common::Json::object();

  /// The network. Throws CheckpointError that begins with `what` when the weights do not fit encoder and
  /// hidden layers.
  Actor actor(const std::string& what = "policy") const;
};

/// Checkpoint of kind "policy" with example inputs and outputs, which load_policy recomputes (within 1e-5).
void save_policy(const std::string& folder, const Policy& policy, const common::Json& run_config,
                 const common::Json& metrics);
/// Writes Policy::provenance into a policy checkpoint that is there.
void set_policy_provenance(const std::string& folder, const common::Json& provenance);
/// Throws CheckpointError.
Policy load_policy(const std::string& folder);

}  // namespace lodestone::inference
