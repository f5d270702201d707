#pragma once

#include <map>
#include <string>

#include <ATen/core/Tensor.h>

#include "lodestone/common/config.h"
#include "lodestone/inference/array.h"

namespace torch::nn {
class Module;
}

namespace lodestone::nets {

/// Tensors by name; order is the names'.
using NamedTensors = std::map<std::string, at::Tensor>;

/// A tensor as an array, and back; without a copy where the tensor lies in the CPU's memory, contiguous: the
/// two then share their numbers. Throws LogicFault unless it holds float32, float64, int64 or uint8.
inference::Array to_array(const at::Tensor& tensor);
at::Tensor to_tensor(const inference::Array& array);
inference::Arrays to_arrays(const NamedTensors& tensors);
NamedTensors to_tensors(const inference::Arrays& arrays);

/// inference::Checkpoint with tensors in its parts.
struct Checkpoint {
  std::string kind;
  common::Json config = common::Json::object();
  common::Json facts = common::Json::object();
  std::map<std::string, NamedTensors> parts;
};

/// As the functions of inference.
void save_checkpoint(const std::string& folder, const Checkpoint& checkpoint);
Checkpoint load_checkpoint(const std::string& folder, const std::string& expected_kind);

/// Parameters and buffers of a module under dotted names, and back (copied in place, shapes and types
/// checked; throws CheckpointError naming the tensor that is missing, unexpected or of another shape).
NamedTensors module_tensors(const torch::nn::Module& module);
void load_module_tensors(torch::nn::Module& module, const NamedTensors& tensors, const std::string& what);

}  // namespace lodestone::nets
