#pragma once

#include <cstdint>

#include "lodestone/data/dataset.h"
#include "lodestone/exports/rig_log.h"

namespace lodestone::exports {

/// Tells `log` what a recording of single pulses holds, and returns the number of steps: the episodes one
/// after another from second 0 on, a control period between two observations and a second between two
/// episodes. Drives in per cent are no currents, and a robot without a heading has 0; what else a log can
/// have is not in a recording.
std::int64_t log_recording(const data::Dataset& dataset, RigLog& log);

}  // namespace lodestone::exports
