#pragma once

#include "lodestone/control/control_loop.h"
#include "lodestone/experiments/trial.h"
#include "lodestone/physics/rig_description.h"

namespace lodestone::experiments {

/// Notes what a trial took, in both its scores: how long it lasted, and what its pulses asked of all coils
/// together: charge, the sum of |current| times the length of a pulse, and heat, that of current squared
/// times the coil's resistance at 20 C times the length. Ramps and what the supervisor cut are left aside.
void note_effort(const control::ControlLoopConfig& loop, const physics::RigDescription& rig,
                 TrialResult& result);

}  // namespace lodestone::experiments
