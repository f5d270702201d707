#include "lodestone/session/operator.h"

#include "lodestone/common/error.h"

namespace lodestone::session {

void AbsentOperator::place(const geometry::Pose2&) {
  throw common::HardwareError(
      "the needle has to be placed elsewhere and nobody can be asked: run this in a terminal");
}

}  // namespace lodestone::session
