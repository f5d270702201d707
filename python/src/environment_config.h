#pragma once

#include <string>

#include "lodestone/common/config.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/region.h"
#include "lodestone/task/task.h"

namespace lodestone::python {

/// What an environment of Python is told: the groups of `lodestone train-policy` that say what is played.
struct EnvironmentConfig {
  task::TaskConfig task;
  task::EncoderConfig encoder;
  task::ActionConfig action;
  env::MbsConfig mbs;
  task::RegionConfig region;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("task", task, "goal, reward and end of an episode");
    v.group("encoder", encoder, "what the policy sees");
    v.group("action", action, "what its actions mean");
    v.group("mbs", mbs, "the learned simulator as an environment");
    v.group("region", region, "how task.within = reachable is mapped from the dynamics' training data");
  }
};

/// What a policy of such an environment needs to know, as checkpoints hold it: encoder, action, goal, rig.
inline common::Json contract_of(const EnvironmentConfig& config, const common::Json& rig) {
  return {{"encoder", task::encoder_to_json(config.encoder)},
          {"action", task::action_to_json(config.action)},
          {"goal", common::name_of(config.task.goal)},
          {"rig", rig}};
}

}  // namespace lodestone::python
