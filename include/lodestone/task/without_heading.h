#pragma once

#include <string>

#include "lodestone/task/observation.h"
#include "lodestone/task/task.h"

namespace lodestone::task {

/// For states without a heading: leaves it out of what a policy sees. Throws ConfigError where the goal is to
/// have one; `whose`: what has none, as its message says it ("a sphere").
void leave_out_heading(TaskConfig& task, EncoderConfig& encoder, const std::string& whose);

}  // namespace lodestone::task
