#include <cstdio>

#include "lodestone/common/error.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/session/rig_session.h"

using namespace lodestone;

/// deploy MODELS: a released policy pulls the needle of a virtual rig, seen by camera, to the dish centre for
/// six seconds, under the supervisor. Exits 0 when it came nearer. For a bench: session::make_bench_session.
int main(int count, char** arguments) try {
  const std::string models = count > 1 ? arguments[1] : "models";
  session::SensingConfig sensing;
  sensing.segmenter = models + "/segmenter";
  const auto rig = session::make_virtual_session({}, sensing, {}, {});
  rig->place({0.015, -0.010, 0.5});

  const inference::Policy policy = inference::load_policy(models + "/centre");
  control::PolicyController controller(policy);
  control::PointReference centre({0.0, 0.0}, 6.0);
  control::ControlLoop loop({}, policy.action, rig->coils(), rig->sensor(), rig->clock());
  const control::LoopOutcome outcome = loop.run(controller, centre);
  if (!outcome.completed) throw common::Error("the run was stopped: " + outcome.stop_reason);

  const double first_m = outcome.steps.front().estimate.pose.position_m().norm();
  const double last_m = outcome.steps.back().estimate.pose.position_m().norm();
  std::printf("%zu pulses: from %.1f mm to %.1f mm off the centre\n", outcome.steps.size() - 1, 1e3 * first_m,
              1e3 * last_m);
  return last_m < 0.5 * first_m ? 0 : 1;
} catch (const common::Error& error) {
  std::fprintf(stderr, "deploy: %s\n", error.what());
  return 1;
}
