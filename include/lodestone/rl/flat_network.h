#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/inference/gemm_bf16.h"
#include "lodestone/nets/checkpoint.h"

namespace lodestone::rl {

/// The widths of a network: inputs, hidden layers, outputs.
inline std::vector<std::int64_t> layer_widths(std::int64_t inputs, const std::vector<std::int64_t>& hidden,
                                              std::int64_t outputs) {
  std::vector<std::int64_t> widths{inputs};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  widths.push_back(outputs);
  return widths;
}

/// Linear layers with ReLU in between, every number in one contiguous tensor so that an optimiser or Polyak
/// step is one pass. Forward and backward are written out (no autograd graph) into preallocated workspaces;
/// bias, ReLU and the ReLU's gradient happen inside the matrix products. Real is float or double.
template <class Real>
class FlatNetwork {
 public:
  /// What does not outlive a layer. Workspaces that are used one after the other may share it.
  struct Scratch {
    inference::CacheAligned<Real> panel;
    inference::CacheAligned<Real> transposed;  ///< a layer's gradient, turned for the product with its input
    inference::Bf16Scratch bf16;
  };
  /// Buffers of one thread for a fixed number of rows.
  struct Workspace {
    std::int64_t rows = 0;
    std::vector<at::Tensor> hidden;  ///< outputs of the hidden layers after ReLU, [rows, w]
    std::vector<at::Tensor> delta;   ///< gradients there
    at::Tensor output;               ///< [rows, out], linear
    at::Tensor input_gradient;       ///< [rows, in]
    at::Tensor gradient;             ///< of the parameters, laid out like them
    std::shared_ptr<Scratch> scratch;
  };
  /// What backward() computes.
  enum class Wanted { kParameters, kInput };

  /// widths: input, hidden..., output. Parameters are zero.
  explicit FlatNetwork(std::vector<std::int64_t> widths);
  /// A copy with storage of its own.
  FlatNetwork clone() const;

  /// From now on products of float matrices round their operands to bfloat16 (inference::multiply_bf16).
  void round_products() { rounds_ = true; }

  /// Uniform in +-1/sqrt(fan in), as torch::nn::Linear does.
  void initialise(common::RandomStream& random);
  Workspace workspace(std::int64_t rows) const;

  /// input [rows, in] -> workspace.output.
  void forward(const Real* input, Workspace& workspace) const;
  /// After forward() with the same input: from the gradient at the output [rows, out] to workspace.gradient
  /// (overwritten) or workspace.input_gradient.
  void backward(const Real* input, const Real* output_gradient, Workspace& workspace, Wanted wanted) const;

  /// One row of numbers, with gaps of zeros that stay zero.
  at::Tensor& parameters() { return parameters_; }
  const at::Tensor& parameters() const { return parameters_; }
  /// Views of any tensor laid out like the parameters: "<prefix>l<first>.weight", "<prefix>l<first>.bias",
  /// ...
  nets::NamedTensors named(const at::Tensor& flat, const std::string& prefix, int first = 1) const;

 private:
  struct Layer {
    std::int64_t in, out;
    std::int64_t weight, bias;  ///< where they begin in the parameters
  };
  void product(const inference::LeftSide<Real>& a, const inference::RightSide<Real>& b, Workspace& workspace,
               Real* out, const inference::Epilogue<Real>& epilogue = {}) const;
  void parameter_gradient(const Layer& layer, const Real* input, const Real* delta,
                          Workspace& workspace) const;

  std::vector<std::int64_t> widths_;
  std::vector<Layer> layers_;
  at::Tensor parameters_;
  bool rounds_ = false;
};

extern template class FlatNetwork<float>;
extern template class FlatNetwork<double>;

}  // namespace lodestone::rl
