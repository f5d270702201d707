#include "lodestone/safety/deadline_check.h"

#include <fmt/core.h>

namespace lodestone::safety {

void DeadlineCheck::begin_step(double now_s, double due_s) {
  const double late_s = now_s - due_s;
  late_steps_ = late_s > max_late_s_ ? late_steps_ + 1 : 0;
  if (late_steps_ >= max_late_steps_)
    throw Distrust(
        fmt::format("{} steps in a row began late, the last by {:g} s, limit is {:g} s: is the machine too "
                    "slow or too busy?",
                    late_steps_, late_s, max_late_s_));
}

}  // namespace lodestone::safety
