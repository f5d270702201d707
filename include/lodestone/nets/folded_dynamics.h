#pragma once

#include <cstdint>
#include <vector>

#include <torch/torch.h>

#include "lodestone/nets/dynamics.h"
#include "lodestone/nets/gemm.h"

namespace lodestone::nets {

/// A dynamics network for fast evaluation: normalisers and batch normalisation (evaluation mode) are folded
/// into the linear layers, so that a step is a few float32 matrix products (lodestone/nets/gemm.h) into
/// buffers that are kept. Agrees with DynamicsNetwork::forward to rounding. predict() is const: threads
/// share the network, each with its own Workspace.
class FoldedDynamics {
 public:
  /// Activations of one thread; grows to the largest batch seen.
  class Workspace {
    friend class FoldedDynamics;
    std::vector<torch::Tensor> activations_;
    std::int64_t rows_ = 0;
  };

  /// Copies the network's weights as they are now.
  explicit FoldedDynamics(DynamicsNetwork& network);

  /// `state` [rows, S] (x_m, y_m[, heading_rad]) and `drive` [rows, 2] in the dataset's unit, row-major;
  /// writes `next` [rows, S] (may be `state`), headings in (-pi, pi]. A row's result does not depend on the
  /// others.
  void predict(const double* state, const double* drive, std::int64_t rows, double* next,
               Workspace& workspace) const;

  /// The same with a draw from the predicted distribution instead of its mean; row i draws from `random[i]`,
  /// which may be one stream for several rows. Where a single value is predicted, that is the draw.
  void sample(const double* state, const double* drive, std::int64_t rows,
              common::RandomStream* const* random, double* next, Workspace& workspace) const;

  int state_size() const { return state_size_; }

 private:
  struct Layer {
    PackedMatrix<float> weight;  ///< [inputs, outputs]
    torch::Tensor bias;          ///< [outputs]
  };

  void write_features(const double* state, const double* drive, std::int64_t rows, float* out) const;
  /// Runs the layers; returns [rows, outputs], which lives in the workspace.
  const float* evaluate(const double* state, const double* drive, std::int64_t rows,
                        Workspace& workspace) const;
  /// Next states from rows of normalised numbers (already in physical units where no mixture is predicted).
  void write_next(const double* state, const float* output, std::int64_t rows, double* next) const;

  std::vector<Layer> layers_;
  int state_size_;
  bool predicts_change_;
  bool sine_cosine_;
  MixtureLayout mixture_;  // no components: a single value
  std::vector<float> output_mean_, output_std_;
};

}  // namespace lodestone::nets
