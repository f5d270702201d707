#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment_run.h"
#include "lodestone/runs/rigs_result.h"

namespace lodestone::experiments {

/// What `bench rigs` is asked for: controllers on many rigs of a kind, with nothing around them unless it
/// says so.
struct RigsBenchConfig {
  DeployConfig deploy;
  std::int64_t rigs = 40;
  std::string controllers = "planner,policy,baseline";
  std::string models;
  bool decorated = false;

  RigsBenchConfig() { deploy.deployment.trials.count = 5; }
  template <class Visitor>
  void visit(Visitor& v) {
    deploy.visit(v);
    v.field("rigs", rigs, "", "rigs that nobody has seen; trials.count is for each of them", {1, 100000});
    v.field("controllers", controllers, "", "what drives, with commas between: planner, policy, baseline");
    v.field(
        "models", models, "",
        "folder that holds the policy as `target` and the simulator as `dynamics_best`, where `policy` and "
        "`dynamics` name none");
    v.field("decorated", decorated, "",
            "put around every controller what the deploy.json beside the policy says; false: what "
            "`decorators` says, nothing by default");
  }
  /// Throws ConfigError where values do not fit each other.
  void validate() const { deploy.validate(); }

  /// The controllers by name. Throws ConfigError naming one that is none, or comes twice.
  std::vector<std::string> controller_names() const;
  /// The deployment that this comes to: every task on every rig. Throws ConfigError, and what reading the
  /// deploy.json throws.
  DeployConfig deployment() const;
};

/// Trials on many rigs as resumable work: the same rigs, starts and targets for every controller.
class RigsRun final : public DeploymentRun {
 public:
  /// `config` is RigsBenchConfig::deployment(); it and `job` must outlive the run.
  RigsRun(const RigsBenchConfig& bench, const DeployConfig& config, const DeploymentJob& job,
          const std::string& folder, TrialDriver driver);

  /// Writes the summary of the trials so far, and what was hidden in their rigs.
  void save(const std::string& folder) override;

  runs::RigsSummary rigs_summary() const;
  runs::RigsResult rigs_result() const;

 private:
  const DeploymentConfig& deployment_;
  const DeploymentJob& job_;
  runs::RigsSummary empty_;
};

}  // namespace lodestone::experiments
