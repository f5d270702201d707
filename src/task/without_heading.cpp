#include "lodestone/task/without_heading.h"

#include "lodestone/common/error.h"

namespace lodestone::task {

void leave_out_heading(TaskConfig& task, EncoderConfig& encoder, const std::string& whose) {
  if (task.goal == GoalKind::kPose)
    throw common::ConfigError("task.goal = \"pose\", but " + whose +
                              " has no heading: set it to centre or point");
  encoder.heading = HeadingEncoding::kNone;
  encoder.target_heading = false;
}

}  // namespace lodestone::task
