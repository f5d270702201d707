#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment_run.h"
#include "lodestone/experiments/learned_rigs.h"
#include "lodestone/runs/rigs_result.h"

namespace lodestone::experiments {

/// What `bench rigs` is asked for: controllers on many rigs of a kind, with nothing around them unless it
/// says so.
struct RigsBenchConfig {
  DeploymentConfig deployment;  ///< trials.count is for each rig
  std::int64_t threads = 0;
  std::int64_t rigs = 40;
  std::string controllers = "planner,policy,baseline";
  std::string models;
  std::string policy;
  std::string dynamics;
  std::string task = "all";
  std::vector<std::int64_t> adapt;
  std::vector<std::int64_t> from_scratch;
  bool decorated = false;

  RigsBenchConfig() { deployment.trials.count = 5; }
  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("rigs", rigs, "", "rigs that nobody has seen; trials.count is for each of them", {1, 100000});
    v.field("controllers", controllers, "",
            "what drives, with commas between: planner, policy, baseline, observer");
    v.field(
        "models", models, "",
        "folder that holds the policy as `any_rig` and the simulator as `dynamics_best`, where `policy` and "
        "`dynamics` name none");
    v.field("policy", policy, "", "folder of the policy checkpoint");
    v.field("dynamics", dynamics, "",
            "folder of the dynamics checkpoint that the planner plans in, and that every controller's rig is "
            "identified by but the observer's");
    v.field("task", task, "", "centre, point, square, circle or all",
            {"centre", "point", "square", "circle", "all"});
    v.field("adapt", adapt, "",
            "planners beside the others that have learned each rig from so many pulses of its own, "
            "from `dynamics` on",
            {1, 1e7});
    v.field("from_scratch", from_scratch, "", "the same, from nothing on", {1, 1e7});
    v.field("decorated", decorated, "",
            "put around every controller what the deploy.json beside the policy says; false: what "
            "`decorators` says, nothing by default");
  }
  /// Throws ConfigError where values do not fit each other.
  void validate() const;

  /// The controllers by name. Throws ConfigError naming one that is none, or comes twice.
  std::vector<std::string> controller_names() const;
  /// Those that learn their rigs first.
  std::vector<RigLearner> learners() const;
  /// What is driven: every task on every rig. Throws ConfigError, and what reading the deploy.json throws.
  DeployConfig deploy() const;
};

/// What drives there: the controllers, and the learners. Throws as plan_job does.
DeploymentJob plan_rigs(const RigsBenchConfig& bench, const DeployConfig& config);

/// Trials on many rigs as resumable work: the same rigs, starts and targets for every controller.
class RigsRun final : public DeploymentRun {
 public:
  /// `config` is RigsBenchConfig::deploy(), `job` from plan_rigs(); both must outlive the run.
  RigsRun(const RigsBenchConfig& bench, const DeployConfig& config, const DeploymentJob& job,
          const std::string& folder, TrialDriver driver);

  /// Writes the summary of the trials so far, and what was hidden in their rigs.
  void save(const std::string& folder) override;

  runs::RigsSummary rigs_summary() const;
  runs::RigsResult rigs_result() const;

 private:
  const DeploymentConfig& deployment_;
  const DeploymentJob& job_;
  std::vector<RigLearner> learners_;
  std::string folder_;
  runs::RigsSummary empty_;
};

}  // namespace lodestone::experiments
