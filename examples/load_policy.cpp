// Loads a policy and asks it for one pulse: where the needle lies and shall go in, the coils' currents out.
//
//   build/examples/load_policy models/centre 0.010 0.020 0.1 0 0
//
// After the policy come x and y of the needle in m, its heading in rad, x and y of the target in m.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/inference/policy.h"
#include "lodestone/physics/coil_drive.h"
#include "lodestone/task/action.h"

using namespace lodestone;

int main(int count, char** words) try {
  if (count != 7)
    throw common::ConfigError("usage: load_policy POLICY X_m Y_m HEADING_rad TARGET_X_m TARGET_Y_m");
  const auto number = [words](int i) {
    char* end = nullptr;
    const double value = std::strtod(words[i], &end);
    if (end == words[i] || *end != '\0') throw common::ConfigError(std::string(words[i]) + " is no number");
    return value;
  };
  const inference::Policy policy = inference::load_policy(words[1]);
  control::PolicyController controller(policy);
  controller.reset();  // before every needle that has been placed

  task::Observation observation;  // in a loop, last_action and last_displacement_m of the step before, too
  observation.pose = {number(2), number(3), number(4)};
  observation.target_m = {number(5), number(6)};
  const geometry::Vector2 action = controller.act(observation);

  const auto current_A = physics::opposed_pairs_A(task::drive_of(action, policy.action));
  std::printf("action %.6f %.6f\n", action.x(), action.y());
  const char* const names[] = {"+x", "-x", "+y", "-y"};
  for (std::size_t coil = 0; coil < current_A.size(); ++coil)
    std::printf("coil %s %.6f %s\n", names[coil], current_A[coil], policy.action.unit.c_str());
} catch (const common::Error& error) {
  std::fprintf(stderr, "load_policy: %s\n", error.what());
  return 1;
}
