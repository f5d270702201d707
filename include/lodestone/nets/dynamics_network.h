#pragma once

#include <cstdint>
#include <vector>

#include <torch/nn/modules/batchnorm.h>
#include <torch/nn/modules/container/sequential.h>
#include <torch/nn/modules/linear.h>

#include "lodestone/inference/folded_dynamics.h"
#include "lodestone/nets/dynamics.h"
#include "lodestone/nets/mixture.h"

namespace lodestone::nets {

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
  MixtureLayout mixture() const { return config_.mixture(layout_); }
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

/// Networks of an ensemble with fresh weights; member k draws from stream ("dynamics", k) of `seed`.
std::vector<std::shared_ptr<DynamicsNetworkImpl>> make_dynamics_members(const DynamicsConfig& config,
                                                                        data::StateLayout layout,
                                                                        std::uint64_t seed);

/// Angles modulo 2 pi in (-pi, pi], element by element.
torch::Tensor wrap_angles(const torch::Tensor& angle_rad);

/// Mean of the members' next states (headings averaged on the circle). Evaluation mode, no gradient.
torch::Tensor predict_mean(DynamicsModel& model, const torch::Tensor& state, const torch::Tensor& action);

/// The network as it is now, normalisers worked into it: what steps without LibTorch.
inference::FoldedDynamics fold(const DynamicsNetworkImpl& network);

}  // namespace lodestone::nets
