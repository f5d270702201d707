#pragma once

#include <ATen/core/Tensor.h>

namespace torch::nn {
class Module;
}

namespace lodestone::nets {

/// Moves a module's parameters, and their gradients, into one array each: optimisers then make a single pass,
/// and a training checkpoint needs one tensor. The module keeps working as before; its parameters become
/// views.
class FlatParameters {
 public:
  /// `module` must have parameters, all float32, and outlive this object's use.
  explicit FlatParameters(torch::nn::Module& module);

  /// [P] float32, every parameter in the module's order.
  at::Tensor& values() { return values_; }
  /// [P] float32, filled by backward().
  at::Tensor& gradient() { return gradient_; }
  void zero_gradient() { gradient_.zero_(); }

 private:
  at::Tensor values_;
  at::Tensor gradient_;
};

}  // namespace lodestone::nets
