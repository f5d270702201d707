#pragma once

#include <torch/torch.h>

namespace lodestone::nets {

/// Moves a module's parameters, and their gradients, into one array each: optimisers then make a single pass,
/// and a training checkpoint needs one tensor. The module keeps working as before; its parameters become
/// views.
class FlatParameters {
 public:
  /// `module` must have parameters, all float32, and outlive this object's use.
  explicit FlatParameters(torch::nn::Module& module);

  /// [P] float32, every parameter in the module's order.
  torch::Tensor& values() { return values_; }
  /// [P] float32, filled by backward().
  torch::Tensor& gradient() { return gradient_; }
  void zero_gradient() { gradient_.zero_(); }

 private:
  torch::Tensor values_;
  torch::Tensor gradient_;
};

}  // namespace lodestone::nets
