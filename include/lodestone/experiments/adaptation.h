#pragma once

#include <string>
#include <vector>

#include "lodestone/data/dataset.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/runs/adaptation_results.h"

namespace lodestone::experiments {

/// The gain of the rig that was recorded, from all its pulses in their order.
task::DriveGain identify(const SimulatorSource& simulator, const control::IdentificationConfig& config,
                         const data::Dataset& recorded);

/// How well a simulator explains recorded pulses with current on a rig of this gain: the natural logarithm of
/// what MotionModel judges, one row for each episode that has any.
std::vector<std::vector<double>> explain(const SimulatorSource& simulator,
                                         const control::IdentificationConfig& config,
                                         const data::Dataset& recorded, double log_drive_gain);

/// Whether a simulator that learned from a rig explains pulses that it did not learn from better than the one
/// it began with (null: none) does, which knows the rig's gain from the others. Fills what of Adaptation
/// follows from them.
runs::Adaptation compare(const SimulatorSource* before, const SimulatorSource& after,
                         const control::IdentificationConfig& config, const data::Dataset& learned_from,
                         const data::Dataset& held_back);

/// The simulator to use lies in folder `model` of an adaptation's run, and the one that it took the place of
/// beside it: copies of checkpoints, swapped in whole. Throws IoError.
void put_model(const std::string& run, const std::string& model);
void keep_before(const std::string& run, const std::string& model);
/// Puts the one from before in the place of the other. Throws ConfigError where there is none.
void roll_back(const std::string& run);

}  // namespace lodestone::experiments
