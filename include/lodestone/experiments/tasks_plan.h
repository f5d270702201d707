#pragma once

#include <cstdint>
#include <string>

#include "lodestone/geometry/path.h"
#include "lodestone/physics/flow.h"
#include "lodestone/physics/rig_description.h"
#include "lodestone/runs/plan.h"

namespace lodestone::experiments {

/// What `bench tasks` is asked for: configs/bench/tasks_{smoke,full}.json.
struct TasksScale {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::int64_t trials = 200;
  std::int64_t oracle_trials = 20;
  std::string controllers = "planner,policy,baseline,observer,oracle";
  std::string tasks;
  std::string models;
  std::string sensor = "camera";

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of starts, targets and rigs; each task draws its own from it", {0, 9e15});
    v.field("threads", threads, "", "cells at the same time, one thread each; 0 means one per processor",
            {0, 1024});
    v.field("trials", trials, "",
            "trials of each task by each controller, each on a rig of its own that nobody has seen",
            {1, 100000});
    v.field("oracle_trials", oracle_trials, "",
            "of these the oracle drives no more than so many, the first ones: it computes for minutes",
            {1, 100000});
    v.field(
        "controllers", controllers, "",
        "what drives, with commas between: planner, policy, baseline, observer, and the oracle, which knows "
        "the rig and tells what could be reached");
    v.field("tasks", tasks, "",
            "only these, with commas between: pose, pose_wide, suture, obstacles, tangent_path, flow, still, "
            "square_at_mm_s; empty: all that this program can drive");
    v.field("models", models, "",
            "folder that holds the policies `any_rig` and `any_pose` and the simulator `dynamics_best`; "
            "empty: the models "
            "that are shipped");
    v.field("sensor", sensor, "", "what poses are sensed by", {"camera", "simulated"});
  }
};

/// The figure of eight that is followed along its direction (a lemniscate of Gerono, 30 mm by 15 mm, closed).
geometry::Path figure_of_eight();
/// Writes it where the plan's cells read it. Throws IoError.
void write_figure_of_eight(const std::string& folder);

/// A cell for each task, controller, and what is put around it, in a plan that is run in `folder` on `rig`;
/// ids are TASK/CONTROLLER/bare and TASK/CONTROLLER/decorated, of the oracle only the former. Every
/// controller meets the same starts, targets and rigs, and so do tasks that go to the same places. A policy
/// for points is not asked for poses unless something turns the needle for it. Throws ConfigError naming a
/// task or controller that is none.
runs::Plan tasks_plan(const TasksScale& scale, const physics::RigDescription& rig, const std::string& folder);

}  // namespace lodestone::experiments
