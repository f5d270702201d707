#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/trial_flow.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::experiments {

/// What `deploy` is asked for.
struct DeployConfig {
  DeploymentConfig deployment;
  std::int64_t threads = 0;
  std::string policy;
  std::string dynamics;
  std::string task = "all";
  std::vector<double> target_mm;
  std::string on_rig = "explored";
  std::string controller = "auto";
  TrialFlow flow = TrialFlow::kAsRig;
  bool realtime = false;
  McapConfig mcap;

  template <class Visitor>
  void visit(Visitor& v) {
    deployment.visit(v);
    v.field("threads", threads, "", "trials at the same time; 0 means one per processor", {0, 1024});
    v.field("policy", policy, "", "folder of the policy checkpoint");
    v.field("dynamics", dynamics, "",
            "folder of the dynamics checkpoint that the planner plans in, and that every controller's rig is "
            "identified by but the observer's");
    v.field("task", task, "",
            "centre, point, pose, square, circle, suture, all, or a path file.csv (columns x_m,y_m, and "
            "heading_rad "
            "where it has headings)");
    v.field("target_mm", target_mm, "mm", "x, y of the target of `point`; drawn for each trial when empty",
            {-1000.0, 1000.0});
    v.field("on_rig", on_rig, "",
            "the rig that was explored, rigs with new friction and calibration error, or both",
            {"explored", "unseen", "both"});
    v.field("controller", controller, "",
            "what drives: a planner in the learned simulator, a trained policy, the proportional baseline, "
            "both of "
            "these; observer: sliding mode with a disturbance observer; auto: the planner where a simulator "
            "is named and no policy is, else both",
            {"auto", "planner", "policy", "baseline", "both", "observer"});
    v.field("flow", flow, "",
            "of a virtual rig: a fluid that moves towards +x, steady, or pulsing once a second, so fast that "
            "its drag on a needle that lies across it is at most half of what friction holds; as_rig: "
            "whatever rig.simulation.flow says");
    v.field("realtime", realtime, "", "wait as long as a real rig would");
    v.group("mcap", mcap, "logs of the trials");
  }
  /// Throws ConfigError where values do not fit each other.
  void validate() const;
};

/// The deployment, its rig in the flow that is asked for. Throws ConfigError where the rig is real, or is
/// told of another one already.
DeploymentConfig in_flow(const DeployConfig& config);

/// What is driven: every task by every controller on every kind of rig.
struct DeploymentJob {
  std::vector<std::string> tasks;
  std::optional<geometry::Path> path;            ///< of task "path"
  std::optional<geometry::Vector2> target_m;     ///< of task "point"; drawn for each trial without
  std::optional<task::Region> region;            ///< that starts and targets lie in
  std::shared_ptr<const task::RouteMap> routes;  ///< by which points are gone to; null: straight to them
  std::vector<RigKind> rigs;
  std::vector<ControllerSource> sources;
  runs::Provenance provenance;  ///< of the policy
};

/// Reads the checkpoints and the path that the configuration names. Throws ConfigError where they do not fit
/// what is asked, and CheckpointError, IoError and DataError where they cannot be read.
DeploymentJob plan_job(const DeployConfig& config);
/// The same with these controllers ("planner", "policy", "baseline", "observer", or the oracle for a virtual
/// rig), whatever the configuration says.
DeploymentJob plan_job(const DeployConfig& config, const std::vector<std::string>& controllers);

}  // namespace lodestone::experiments
