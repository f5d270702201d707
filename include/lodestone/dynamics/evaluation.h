#pragma once

#include "lodestone/data/dataset.h"
#include "lodestone/dynamics/model.h"
#include "lodestone/runs/training_results.h"

namespace lodestone::dynamics {

using runs::DynamicsEvaluation;
using runs::ErrorCell;
using runs::StateError;

/// How well an ensemble's mean predicts recorded transitions (section V-A, and more), the facts of training
/// left out. Rows of `dataset` as evaluation uses them. Open-loop chains, of the model and of both baselines,
/// stay within episodes and leave zero-current pulses without motion, as the MBS does. Where distributions
/// are predicted, how often their regions hold what was recorded (region_coverage.h). Throws DataError when
/// the dataset has another state layout or no row.
DynamicsEvaluation evaluate_dynamics(const Model& model, const data::Dataset& dataset);

/// Adds errors open loop of means of `draws` runs from every row, each of which draws what it meets
/// (trajectory sampling: Chua et al., NeurIPS 2018): of the model, whose k-th run is of member k modulo their
/// number, and of the ten neighbours. What may go either way is best foretold so; the mean that
/// evaluate_dynamics() runs on is a state in which no needle ever is. Keeps all runs in memory.
void add_drawn_open_loop(const Model& model, const data::Dataset& dataset, std::int64_t draws,
                         DynamicsEvaluation& evaluation);

/// The episodes that were set aside when the model was trained on this data.
data::Dataset test_split(const Model& model, const data::Dataset& dataset);

}  // namespace lodestone::dynamics
