#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/inference/folded_dynamics.h"
#include "lodestone/nets/layers.h"
#include "lodestone/nets/parameters.h"

namespace lodestone::dynamics {

using inference::DynamicsConfig;

/// One network with its normalisers as buffers: batch normalisation of the input (and ReLU, where
/// `input_relu` says so), then for each hidden layer linear, batch normalisation and ReLU, then linear. Where
/// the rig has a symmetry (`symmetry`) rows are first turned and mirrored into the same eighth of the dish,
/// and what comes out is turned and mirrored back: equivariance by canonicalisation (Kaba et al., ICML,
/// 2023). Where `symmetry_exact` is false the view goes in, too, at first without weight: what looks the same
/// comes out the same until pulses tell otherwise. Parameters and buffers are float32. Input [N, S] state
/// (x_m, y_m[, heading_rad]) and [N, A] drives in the dataset's unit; output [N, S] next state: the mean
/// where a distribution is predicted. Section IV-B1.
class Network {
 public:
  /// Weights are zero until initialise() or tensors().load().
  Network(const DynamicsConfig& config, const data::RowLayout& rows);
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// Draws every linear layer from `random`.
  void initialise(common::RandomStream& random);
  /// Whether batches are normalised by their own statistics, which then move the running ones. At first so.
  void train(bool training) { training_ = training; }

  /// Next state [N, S], heading wrapped to (-pi, pi].
  at::Tensor forward(const at::Tensor& state, const at::Tensor& action) const;
  /// What layers() end with: the numbers themselves, or a mixture over them.
  inference::MixtureLayout mixture() const { return config_.mixture(layout_); }
  /// The layers alone: normalised_input() -> [N, S], or [N, mixture().outputs()].
  at::Tensor layers(const at::Tensor& input) const;
  /// What layers() take, [N, inputs] float32: features less their mean, by their standard deviation.
  at::Tensor normalised_input(const at::Tensor& state, const at::Tensor& action) const;
  /// Expected output, and what it should be: both [N, S] float32.
  at::Tensor normalised_output(const at::Tensor& state, const at::Tensor& action) const;
  at::Tensor normalised_target(const at::Tensor& state, const at::Tensor& next_state) const;
  /// Sets input and output mean and standard deviation from training rows (float32 or float64).
  void fit_normalisers(const at::Tensor& state, const at::Tensor& action, const at::Tensor& next_state);

  /// From now on a drive counts for `gain` times as much.
  void scale_drive(double gain);

  const DynamicsConfig& config() const { return config_; }
  data::StateLayout layout() const { return layout_; }
  data::RowLayout rows() const { return {layout_, action_size_}; }
  nets::Parameters& tensors() { return tensors_; }
  const nets::Parameters& tensors() const { return tensors_; }

  at::Tensor input_mean, input_std, output_mean, output_std;  ///< buffers

 private:
  /// Raw network input from physical quantities, [N, inputs],
  at::Tensor features(const at::Tensor& state, const at::Tensor& action) const;
  /// once they are seen as the symmetry has it, in these `views` [N, 3] where those go in,
  at::Tensor seen_features(const at::Tensor& state, const at::Tensor& action, const at::Tensor& views) const;
  /// and what should come out, [N, S], in the same view.
  at::Tensor target(const at::Tensor& state, const at::Tensor& next_state) const;

  /// Of [..., inputs], a number for each input, those that tell the view; none where it does not go in.
  at::Tensor view_columns(const at::Tensor& by_input) const;

  DynamicsConfig config_;
  data::StateLayout layout_;
  int action_size_;
  bool training_ = true;
  nets::Parameters tensors_;
  std::vector<nets::Linear> linear_;
  std::vector<nets::BatchNorm> norm_;  // of the input and of each hidden layer, or none
};

using Members = std::vector<std::shared_ptr<Network>>;

/// Networks of an ensemble with fresh weights; member k draws from stream ("dynamics", k) of `seed`.
Members make_members(const DynamicsConfig& config, const data::RowLayout& rows, std::uint64_t seed);

/// Mean of the members' next states [N, S] (headings averaged on the circle). Evaluation mode, no gradient.
at::Tensor predict_mean(const Members& members, const at::Tensor& state, const at::Tensor& action);

/// Angles modulo 2 pi in (-pi, pi], element by element.
at::Tensor wrap_angles(const at::Tensor& angle_rad);

/// The network as it is now, normalisers worked into it: what steps without LibTorch.
inference::FoldedDynamics fold(const Network& network);

}  // namespace lodestone::dynamics
