#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/data/dataset.h"

namespace lodestone::nets {

/// Shape of the learned dynamics.
struct DynamicsConfig {
  std::string form = "paper";  ///< "paper": theta in, next state out; "delta": sine and cosine in, change out
  std::vector<std::int64_t> hidden = {256, 128, 32};
  bool batch_norm = true;      ///< on the input and every hidden layer
  std::int64_t members = 1;    ///< ensemble size

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("form", form, "", "what goes in and out", {"paper", "delta"});
    v.field("hidden", hidden, "", "width of each hidden layer", {1, 8192});
    v.field("batch_norm", batch_norm, "", "batch normalisation on input and hidden layers");
    v.field("members", members, "", "networks in the ensemble", {1, 64});
  }
};

/// One network with its normalisers as buffers. Input [N, S] state (x_m, y_m[, heading_rad]) and [N, 2] drives in the
/// dataset's unit; output [N, S] next state. Section IV-B1.
class DynamicsNetworkImpl : public torch::nn::Module {
 public:
  DynamicsNetworkImpl(const DynamicsConfig& config, data::StateLayout layout);

  /// Next state, heading wrapped to (-pi, pi].
  torch::Tensor forward(const torch::Tensor& state, const torch::Tensor& action);
  /// Normalised network output and target for training losses, both [N, S].
  torch::Tensor normalised_output(const torch::Tensor& state, const torch::Tensor& action);
  torch::Tensor normalised_target(const torch::Tensor& state, const torch::Tensor& next_state);
  /// Sets input and output mean and standard deviation from training rows.
  void fit_normalisers(const torch::Tensor& state, const torch::Tensor& action, const torch::Tensor& next_state);

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

/// A trained ensemble with what it was trained on: all an MBS needs.
struct DynamicsModel {
  DynamicsConfig config;
  data::DatasetInfo info;  ///< layout, action unit and scale, workspace of the training data
  std::vector<DynamicsNetwork> members;
  torch::Tensor start_states;  ///< [M, S] float64, states seen in training: where episodes may start
};

/// Mean of the members' next states (headings averaged on the circle). Evaluation mode, no gradient.
torch::Tensor predict_mean(DynamicsModel& model, const torch::Tensor& state, const torch::Tensor& action);

/// Checkpoint of kind "dynamics".
void save_dynamics(const std::string& folder, const DynamicsModel& model, const common::Json& run_config,
                   const common::Json& metrics);
/// Throws CheckpointError.
DynamicsModel load_dynamics(const std::string& folder);

}  // namespace lodestone::nets
