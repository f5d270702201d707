#pragma once

#include <cstdint>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/identification_config.h"
#include "lodestone/control/planner.h"

namespace lodestone::experiments {

/// The short deployment at the end of a qualification. Rig, limits, sensor, loop, baseline and seeds are the
/// qualification's own; the rest is as in deploy.
struct PointsConfig {
  std::string policy;
  std::string dynamics;
  std::string controller = "auto";
  std::int64_t count = 16;
  double seconds = 20.0;
  control::DecoratorConfig decorators;
  control::PlannerConfig planner;
  control::IdentificationConfig identification;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("policy", policy, "", "folder of the policy checkpoint");
    v.field("dynamics", dynamics, "",
            "folder of the dynamics checkpoint that the planner plans in, and that every controller's rig is "
            "identified by");
    v.field("controller", controller, "",
            "what drives; auto: the policy, where none is named the planner, and without a simulator the "
            "baseline, which has learned nothing",
            {"auto", "planner", "policy", "baseline"});
    v.field("count", count, "", "trials, as far as there is time; 0: none", {0, 1000});
    v.field("seconds", seconds, "s", "length of a trial", {0.1, 3600.0});
    v.group("decorators", decorators, "what is put around the controller");
    v.group("planner", planner, "planning in the learned simulator");
    v.group("identification", identification,
            "what the pulses say about the rig, where a learned simulator is named (dynamics)");
  }
  void validate() const {
    const std::string named = driven_by();
    if (named == "policy" && policy.empty())
      throw common::InvalidConfig("controller", controller, "come with a policy: points.policy (--policy)");
    if (named == "planner" && dynamics.empty())
      throw common::InvalidConfig("controller", controller,
                                  "come with a simulator to plan in: points.dynamics (--models)");
  }

  /// "policy", "planner" or "baseline".
  std::string driven_by() const {
    if (controller != "auto") return controller;
    if (!policy.empty()) return "policy";
    return dynamics.empty() ? "baseline" : "planner";
  }
};

}  // namespace lodestone::experiments
