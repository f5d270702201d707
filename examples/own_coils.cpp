// Coils of your own (amplifier_coils.h) behind the supervisor, in the control loop: a proportional pull
// brings the needle of a virtual rig to the dish centre, and every pulse is logged.
//
//   build/examples/own_coils pulses.csv
#include <cstdio>
#include <fstream>

#include "amplifier_coils.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/sensing.h"

using namespace lodestone;

int main(int count, char** words) try {
  if (count != 2) throw common::ConfigError("usage: own_coils LOG.csv");
  const rig::VirtualRigConfig description;  // the paper's rig
  rig::VirtualRig rig(description, 1);
  rig.place({0.020, 0.015, 0.5});
  vendor::Amplifier amplifier(rig.coils());
  std::ofstream log(words[1]);
  if (!log) throw common::IoError(std::string(words[1]) + " cannot be written");
  AmplifierCoils coils(amplifier, log);

  safety::SafetyConfig limits;
  limits.max_current_A = 10.0;  // of 15 that the rig takes
  safety::Supervisor supervisor(coils, limits, description, rig.clock());

  session::SensingConfig seen;
  seen.kind = "simulated";  // or "camera", with a segmenter
  const session::Sensing sensing(seen, description);
  const auto sensor = sensing.make(rig, sensing.calibrated_bench(1), common::RandomStream(1, "sensor noise"));

  control::DipolePullController controller(description, {});
  control::PointReference centre({0.0, 0.0}, 12.0);
  task::ActionConfig action;
  action.scale = description.coils.max_current_A;
  control::ControlLoop loop({}, action, supervisor, *sensor, rig.clock());
  const control::LoopOutcome outcome = loop.run(controller, centre);
  if (!outcome.completed) throw common::Error("the run was stopped: " + outcome.stop_reason);

  const auto from_centre_mm = [](const control::StepRecord& step) {
    return 1e3 * step.estimate.pose.position_m().norm();
  };
  std::printf("%zu pulses, %lld of them cut to 10 A: from %.2f mm to %.2f mm off the centre\n",
              outcome.steps.size() - 1, static_cast<long long>(supervisor.limited()),
              from_centre_mm(outcome.steps.front()), from_centre_mm(outcome.steps.back()));
} catch (const common::Error& error) {
  std::fprintf(stderr, "own_coils: %s\n", error.what());
  return 1;
}
