#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/data/dataset.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/env/physics_env.h"
#include "lodestone/env/replay_env.h"
#include "lodestone/env/vec_env.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/rl/learning_config.h"
#include "lodestone/rl/model_gradient_config.h"
#include "lodestone/rl/ou_noise.h"
#include "lodestone/rl/policy_evaluation.h"
#include "lodestone/rl/td3_config.h"
#include "lodestone/rl/value_iteration_config.h"
#include "lodestone/runs/run_folder.h"
#include "lodestone/runs/training_results.h"
#include "lodestone/task/action.h"
#include "lodestone/task/observation.h"
#include "lodestone/task/task.h"

namespace lodestone::rl {

class PolicyLearner;

/// What a policy is trained in: the learned simulator (MBS), or the plain one of section IV-C.
enum class Simulator { kMbs, kPhysics };
inline std::vector<std::string> names_of(Simulator) { return {"mbs", "physics"}; }

/// How a policy is learned: from rewards (section IV-B2), down the gradient of the learned simulator, or from
/// the decisions of a planner in it that learns what poses cost.
enum class Method { kTd3, kModelGradient, kValueIteration };
inline std::vector<std::string> names_of(Method) { return {"td3", "model_gradient", "value_iteration"}; }

/// The run around the learner.
struct PolicyTrainingConfig {
  LearningConfig learning;
  std::int64_t environments = 3;
  std::int64_t evaluate_every = 20000;
  std::int64_t evaluation_episodes = 200;
  double checkpoint_every_s = 60.0;
  double max_seconds = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    learning.visit(v);
    v.field("environments", environments, "", "environments stepped together (the paper has 3)",
            {1, 1 << 20});
    v.field("evaluate_every", evaluate_every, "steps", "environment steps between evaluations", {1, 1e12});
    v.field("evaluation_episodes", evaluation_episodes, "",
            "fixed starts and goals of every evaluation, by which the best policy is kept (with method = "
            "value_iteration the latest); as many fresh ones score it in the end",
            {1, 1 << 20});
    v.field("checkpoint_every_s", checkpoint_every_s, "s", "time between training checkpoints", {0.0, 1e6});
    v.field("max_seconds", max_seconds, "s",
            "stop after this training time (then results depend on the machine); 0: no limit", {0.0, 1e7});
  }
};

/// Everything `lodestone train-policy` is told.
struct TrainPolicyConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  Method method = Method::kTd3;
  std::string dynamics;
  Simulator simulator = Simulator::kMbs;
  std::string recorded;
  physics::RigDescription rig;
  task::TaskConfig task;
  task::EncoderConfig encoder;
  task::ActionConfig action;
  env::MbsConfig mbs;
  env::PhysicsEnvConfig physics;
  env::ReplayConfig replay;
  task::RegionConfig region;
  Td3Config td3;
  NoiseConfig noise;
  ModelGradientConfig model_gradient;
  ValueIterationConfig value_iteration;
  PolicyTrainingConfig training;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of every random stream of the run", {0, 9e15});
    v.field("threads", threads, "", "threads; 0 means one per processor", {0, 1024});
    v.field("method", method, "",
            "how the policy is learned: by TD3 from rewards, down the gradient of what the learned simulator "
            "expects of a pulse, or, for poses, by value iteration in it");
    v.field("dynamics", dynamics, "", "dynamics checkpoint: folder that train-dynamics wrote");
    v.field("simulator", simulator, "",
            "what the policy is trained in: the learned MBS, or the simulator of IV-C");
    v.field("recorded", recorded, "",
            "transitions that replay.environments play back, as in train-dynamics' data");
    v.retired("adopt_data", "nothing: what the data say of the rig is always taken from them");
    v.group("rig", rig, "the rig, where no recorded data say what it is");
    v.group("task", task, "goal, reward and end of an episode");
    v.group("encoder", encoder, "what the policy sees");
    v.group("action", action, "what its actions mean");
    v.group("mbs", mbs, "the learned simulator as an environment");
    v.group("physics", physics, "the simulator of section IV-C as an environment");
    v.group("replay", replay, "recorded steps as an environment (section V-C)");
    v.group("region", region, "how task.within = reachable is mapped from the dynamics' training data");
    v.group("td3", td3, "the learner of method td3");
    v.group("noise", noise, "its exploration");
    v.group("model_gradient", model_gradient, "the learner of method model_gradient");
    v.group("value_iteration", value_iteration, "the learner of method value_iteration");
    v.group("training", training, "how long, how often");
  }
  /// Throws ConfigError when nothing would be learned.
  void validate() const;
  /// Pulses that the policy proposes; 0: it gives one.
  std::int64_t proposals() const {
    if (method == Method::kValueIteration) return value_iteration.proposals;
    return method == Method::kTd3 ? 0 : model_gradient.proposals;
  }
  /// Widths of the policy's hidden layers.
  const std::vector<std::int64_t>& hidden() const {
    if (method == Method::kValueIteration) return value_iteration.hidden;
    return method == Method::kTd3 ? td3.hidden : model_gradient.hidden;
  }

  common::Json learned_rig;  ///< no key: the rig that the policy is for, null where nobody says
};

/// Fills in what the rig says: workspace radius, and the drive that an action of 1 means.
TrainPolicyConfig adopt_rig(TrainPolicyConfig config);
/// Fills in what the dynamics' training data say: the same two, the one-axis rule, and that there is no
/// heading.
TrainPolicyConfig adopt_data(TrainPolicyConfig config, const data::DatasetInfo& info);

/// The run of a configuration, and which of its keys may change when it is gone on with.
runs::RunRequest run_request(const TrainPolicyConfig& config, const std::string& folder, bool resume);

/// Where a policy is scored. Both must outlive the training and have seeds of their own.
struct ScoringEnvironments {
  env::VecEnv& choice;  ///< while it learns, the same episodes each time, by which a policy is kept
  env::VecEnv& fresh;   ///< once, at the end, the policy that was kept: nothing is chosen by them
};

/// Trains until env_steps, writing into the run's folder: metrics (the first line is of the untrained
/// policy), `checkpoint` (the policy with the best evaluation return so far; the latest, where a cost-to-go
/// is learned beside it) and, every checkpoint_every_s, `training`, from which a resumption goes on bitwise.
/// At the end what was kept is scored in fresh episodes, which its checkpoint then names, too: one that was
/// cut off knows only the score that it was chosen by. Throws Interrupted after saving when the user asked to
/// stop, and CheckpointError. `region`, when given, is kept with the policy.
runs::PolicyResult train_policy(const TrainPolicyConfig& config, PolicyLearner& learner,
                                const ScoringEnvironments& scoring, runs::RunFolder& run,
                                const task::Region* region = nullptr);

}  // namespace lodestone::rl
