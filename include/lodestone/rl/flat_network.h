#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/random.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::rl {

/// Linear layers with ReLU in between, every number in one contiguous tensor so that an optimiser or Polyak
/// step is one pass. Forward and backward are written out (no autograd graph) into preallocated workspaces.
class FlatNetwork {
 public:
  /// Scratch of one thread for a fixed number of rows.
  struct Workspace {
    std::vector<torch::Tensor> hidden;  ///< outputs of the hidden layers after ReLU, [n, w]
    std::vector<torch::Tensor> delta;   ///< gradients there
    torch::Tensor output;               ///< [n, out], linear
    torch::Tensor input_gradient;       ///< [n, in]
    torch::Tensor gradient;             ///< of the parameters, laid out like them
    std::vector<torch::Tensor> weight_gradient, bias_gradient;  ///< views of `gradient`
  };
  /// What backward() computes.
  enum class Wanted { kParameters, kInput };

  /// widths: input, hidden..., output. float32 or float64.
  FlatNetwork(std::vector<std::int64_t> widths, torch::ScalarType type);
  /// A copy with storage of its own.
  FlatNetwork clone() const;

  /// Uniform in +-1/sqrt(fan in), as torch::nn::Linear does.
  void initialise(common::RandomStream& random);
  Workspace workspace(std::int64_t rows) const;

  /// input [n, in] -> workspace.output. The caller holds a NoGradGuard.
  const torch::Tensor& forward(const torch::Tensor& input, Workspace& workspace) const;
  /// After forward() with the same input: from the gradient at the output [n, out] to workspace.gradient
  /// (overwritten) or workspace.input_gradient.
  void backward(const torch::Tensor& input, const torch::Tensor& output_gradient, Workspace& workspace,
                Wanted wanted) const;

  torch::Tensor& parameters() { return parameters_; }
  const torch::Tensor& parameters() const { return parameters_; }
  /// Views of any tensor laid out like the parameters: "<prefix>l<first>.weight", "<prefix>l<first>.bias",
  /// ...
  nets::NamedTensors named(const torch::Tensor& flat, const std::string& prefix, int first = 1) const;

 private:
  std::vector<torch::Tensor> views(const torch::Tensor& flat, bool weights) const;

  std::vector<std::int64_t> widths_;
  std::vector<std::int64_t> offsets_;  // of weight 1, bias 1, weight 2, ...
  torch::Tensor parameters_;
  std::vector<torch::Tensor> weights_, biases_;
};

}  // namespace lodestone::rl
