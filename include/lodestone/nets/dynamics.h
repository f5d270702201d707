#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/data/dataset.h"
#include "lodestone/nets/mixture.h"
#include "lodestone/task/region.h"

namespace lodestone::nets {

/// Shape of the learned dynamics.
struct DynamicsConfig {
  std::string form = "paper";  ///< "paper": theta in, next state out; "delta": sine and cosine in, change out
  std::vector<std::int64_t> hidden = {256, 128, 32};
  bool batch_norm = true;    ///< on the input and every hidden layer
  std::int64_t members = 1;  ///< ensemble size
  std::int64_t components =
      0;  ///< Gaussians of the predicted distribution; 0: a single value, as in the paper

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("form", form, "", "what goes in and out", {"paper", "delta"});
    v.field("hidden", hidden, "", "width of each hidden layer", {1, 8192});
    v.field("batch_norm", batch_norm, "", "batch normalisation on input and hidden layers");
    v.field("members", members, "", "networks in the ensemble", {1, 64});
    v.field(
        "components", components, "",
        "Gaussians in the mixture that each network predicts (stick-slip is random, and a mean hides it); 0: "
        "a single value, as in the paper",
        {0, 16});
  }
};

/// One network with its normalisers as buffers: batch normalisation of the input, then for each hidden layer
/// linear, batch normalisation and ReLU, then linear. Parameters and buffers are float32. Input [N, S] state
/// (x_m, y_m[, heading_rad]) and [N, 2] drives in the dataset's unit; output [N, S] next state: the mean
/// where a distribution is predicted. Section IV-B1.
class DynamicsNetworkImpl : public torch::nn::Module {
 public:
  DynamicsNetworkImpl(const DynamicsConfig& config, data::StateLayout layout);

  /// Next state [N, S], heading wrapped to (-pi, pi].
  torch::Tensor forward(const torch::Tensor& state, const torch::Tensor& action);
  /// What layers() end with: the numbers themselves, or a mixture over them.
  MixtureLayout mixture() const { return {config_.components, data::state_size(layout_)}; }
  /// What layers() take, [N, 4..6] float32: features less their mean, by their standard deviation.
  torch::Tensor normalised_input(const torch::Tensor& state, const torch::Tensor& action) const;
  /// Expected output, and what it should be: both [N, S] float32.
  torch::Tensor normalised_output(const torch::Tensor& state, const torch::Tensor& action);
  torch::Tensor normalised_target(const torch::Tensor& state, const torch::Tensor& next_state) const;
  /// Sets input and output mean and standard deviation from training rows (float32 or float64).
  void fit_normalisers(const torch::Tensor& state, const torch::Tensor& action,
                       const torch::Tensor& next_state);

  const DynamicsConfig& config() const { return config_; }
  data::StateLayout layout() const { return layout_; }
  /// Raw network input from physical quantities, [N, 4..6]; used when the network is folded.
  torch::Tensor features(const torch::Tensor& state, const torch::Tensor& action) const;
  torch::nn::Sequential& layers() { return layers_; }

  torch::Tensor input_mean, input_std, output_mean, output_std;  ///< buffers

 private:
  DynamicsConfig config_;
  data::StateLayout layout_;
  torch::nn::Sequential layers_{nullptr};
};
TORCH_MODULE(DynamicsNetwork);

/// How rows were set aside at training; evaluation takes up the same split.
struct DynamicsSplit {
  std::uint64_t seed = 0;
  double validation_fraction = 0.1;
  double test_fraction = 0.1;
};

/// The transitions a model was trained on, [M, S], [M, 2], [M, S] float32; the nearest-neighbour baseline
/// needs them.
struct TrainingRows {
  torch::Tensor state;
  torch::Tensor action;
  torch::Tensor next_state;
};

/// A trained ensemble with what it was trained on: all an MBS needs.
struct DynamicsModel {
  DynamicsConfig config;
  data::DatasetInfo info;  ///< layout, action unit and scale, workspace of the training data
  std::vector<DynamicsNetwork> members;
  torch::Tensor start_states;  ///< [M, S] float64, states seen in training: where episodes may start
  DynamicsSplit split;
  TrainingRows training_rows;
};

/// Networks of an ensemble with fresh weights; member k draws from stream ("dynamics", k) of `seed`.
std::vector<DynamicsNetwork> make_dynamics_members(const DynamicsConfig& config, data::StateLayout layout,
                                                   std::uint64_t seed);

/// Dataset description as JSON and back, as checkpoints hold it. Throws CheckpointError naming `what`.
common::Json dataset_info_to_json(const data::DatasetInfo& info);
data::DatasetInfo dataset_info_from_json(const common::Json& json, const std::string& what);

/// Angles modulo 2 pi in (-pi, pi], element by element.
torch::Tensor wrap_angles(const torch::Tensor& angle_rad);

/// Mean of the members' next states (headings averaged on the circle). Evaluation mode, no gradient.
torch::Tensor predict_mean(DynamicsModel& model, const torch::Tensor& state, const torch::Tensor& action);

/// The positions between which the training rows moved.
std::vector<task::Move> recorded_moves(const DynamicsModel& model);

/// Checkpoint of kind "dynamics".
void save_dynamics(const std::string& folder, const DynamicsModel& model, const common::Json& run_config,
                   const common::Json& metrics);
/// Throws CheckpointError.
DynamicsModel load_dynamics(const std::string& folder);

}  // namespace lodestone::nets
