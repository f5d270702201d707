#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/nets/tensors.h"

namespace lodestone::nets {

/// The tensors of one network by name, in the order in which they were added: parameters, which learn, and
/// buffers (running statistics, normalisers), which do not.
class Parameters {
 public:
  /// A float32 parameter of zeros that wants a gradient.
  at::Tensor add(const std::string& name, const std::vector<std::int64_t>& shape);
  /// Keeps `value`, whose type stays.
  at::Tensor add_buffer(const std::string& name, const at::Tensor& value);

  std::vector<at::Tensor> parameters() const;
  std::vector<at::Tensor> buffers() const;

  /// Moves the parameters, and their gradients, into one array each: optimisers then make a single pass, and
  /// a training checkpoint needs one tensor. Tensors that were handed out stay the network's.
  void flatten();
  /// After flatten(): [P] float32, every parameter in its order.
  at::Tensor& values() { return values_; }
  /// After flatten(): [P] float32, filled by backward().
  at::Tensor& gradient() { return gradient_; }

  /// Parameters and buffers by name, sharing their numbers.
  NamedTensors named() const;
  /// Copies into them. Throws CheckpointError that begins with `what` and names the tensor that is missing,
  /// unexpected or of another shape or type.
  void load(const NamedTensors& tensors, const std::string& what);

 private:
  using Entries = std::vector<std::pair<std::string, at::Tensor>>;
  Entries parameters_, buffers_;
  at::Tensor values_, gradient_;
};

}  // namespace lodestone::nets
