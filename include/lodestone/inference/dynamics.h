#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/dataset.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/folded_dynamics.h"
#include "lodestone/task/region.h"

namespace lodestone::inference {

/// A learned simulator ready to be stepped: all that an MBS or a planner needs.
struct DynamicsModel {
  DynamicsConfig config;
  data::DatasetInfo info;                  ///< layout, action unit and scale, workspace of the training data
  std::vector<FoldedDynamics> members;     ///< of the ensemble
  std::vector<double> start_states;        ///< [M, S], states seen in training: where episodes may start
  std::vector<task::Move> recorded_moves;  ///< of the training rows
};

/// From a checkpoint of kind "dynamics", which dynamics::save_model writes. Throws CheckpointError.
DynamicsModel load_dynamics(const std::string& folder);

/// What all members together expect, their mean: writes `next` [rows, S] for `state` [rows, S] and `drive`
/// [rows, A] in the dataset's unit. Headings are averaged as turns from the present one, which no cut of the
/// circle can split. `one_member` is scratch. `next` must not be `state`.
void predict_mean(const std::vector<FoldedDynamics>& members, const double* state, const double* drive,
                  std::int64_t rows, double* next, std::vector<double>& one_member,
                  FoldedDynamics::Workspace& workspace);

/// Shape and dataset that a checkpoint's facts tell. Throws CheckpointError naming `what`.
DynamicsConfig dynamics_config_of(const common::Json& facts, const std::string& what);
data::DatasetInfo dataset_info_of(const common::Json& facts, const std::string& what);
/// Dataset description as checkpoints hold it.

/// Rows that the model was trained on, [N, columns] of finite numbers, from part "rows". Throws
/// CheckpointError naming `what`.
const Array& training_rows(const Checkpoint& checkpoint, const std::string& name, std::int64_t columns,
                           const std::string& what);

/// Part of a checkpoint that holds a member of the ensemble.
std::string member_part(std::size_t member);

}  // namespace lodestone::inference
