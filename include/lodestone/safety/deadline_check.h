#pragma once

#include <cstdint>

#include "lodestone/safety/check.h"

namespace lodestone::safety {

/// Steps that begin late, several in a row: the machine is too slow or too busy.
class DeadlineCheck final : public StepCheck {
 public:
  DeadlineCheck(double max_late_s, std::int64_t max_late_steps)
      : max_late_s_(max_late_s), max_late_steps_(max_late_steps) {}
  void begin_step(double now_s, double due_s) override;

 private:
  double max_late_s_;
  std::int64_t max_late_steps_;
  std::int64_t late_steps_ = 0;
};

}  // namespace lodestone::safety
