#pragma once

#include <cstdint>
#include <vector>

#include <torch/torch.h>

#include "lodestone/nets/dynamics.h"
#include "lodestone/nets/gemm.h"

namespace lodestone::nets {

/// A dynamics network for fast evaluation: normalisers and batch normalisation (evaluation mode) are folded
/// into the linear layers, so that a step is a few float32 matrix products (lodestone/nets/gemm.h) into
/// buffers that are kept. Agrees with DynamicsNetwork::forward to rounding. predict() is const: threads share
/// the network, each with its own Workspace.
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

  int state_size() const { return state_size_; }

 private:
  struct Layer {
    PackedMatrix<float> weight;  ///< [inputs, outputs]
    torch::Tensor bias;          ///< [outputs]
  };

  void write_features(const double* state, const double* drive, std::int64_t rows, float* out) const;
  void write_next(const double* state, const float* output, std::int64_t rows, double* next) const;

  std::vector<Layer> layers_;
  int state_size_;
  bool predicts_change_;
  bool sine_cosine_;
};

}  // namespace lodestone::nets
