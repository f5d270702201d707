#pragma once

#include "lodestone/control/control_loop.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// Holds every item of a qualification against its bounds, and says what to mend first: of what is beyond
/// them, what is furthest. The error to expect is held against bounds, too, but is what all the others come
/// to, and never what to mend. `loop`: the pulses and rests that the bench is to be driven with.
void judge(runs::QualificationResult& result, const control::ControlLoopConfig& loop);

}  // namespace lodestone::experiments
