#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/dataset.h"
#include "lodestone/inference/array.h"
#include "lodestone/inference/dynamics_config.h"

namespace lodestone::dynamics {

using inference::DynamicsConfig;
class Network;

/// How rows were set aside at training; evaluation takes up the same split.
struct DataSplit {
  std::uint64_t seed = 0;
  double validation_fraction = 0.1;
  double test_fraction = 0.1;
};

/// The transitions a model was trained on, [M, S], [M, 2], [M, S] float32; the nearest-neighbour baseline
/// needs them.
struct TrainingRows {
  inference::Array state;
  inference::Array action;
  inference::Array next_state;
};

/// A trained ensemble with what it was trained on: all an MBS needs.
struct Model {
  DynamicsConfig config;
  data::DatasetInfo info;  ///< layout, action unit and scale, workspace of the training data
  std::vector<std::shared_ptr<Network>> members;
  inference::Array start_states;  ///< [M, S] float64, states seen in training: where episodes may start
  DataSplit split;
  TrainingRows training_rows;
};

/// Checkpoint of kind "dynamics".
void save_model(const std::string& folder, const Model& model, const common::Json& run_config,
                const common::Json& metrics);
/// Throws CheckpointError.
Model load_model(const std::string& folder);

}  // namespace lodestone::dynamics
