#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/inference/array.h"

namespace lodestone::nets {

/// Tensors by name; order is the names'.
using NamedTensors = std::map<std::string, at::Tensor>;

/// A tensor as an array, and back; without a copy where the tensor lies in the CPU's memory, contiguous: the
/// two then share their numbers. Throws LogicFault unless it holds float32, float64, int64 or uint8.
inference::Array to_array(const at::Tensor& tensor);
at::Tensor to_tensor(const inference::Array& array);
inference::Arrays to_arrays(const NamedTensors& tensors);
NamedTensors to_tensors(const inference::Arrays& arrays);

/// Copy of numbers as a tensor of `type` and `shape`. Throws LogicFault when the shape holds another number
/// of them.
at::Tensor tensor_from(const std::vector<double>& values, const std::vector<std::int64_t>& shape,
                       at::ScalarType type = at::kDouble);
/// Throws LogicFault that begins with `what` unless the tensor is contiguous, of `shape` and `type`.
void check_tensor(const at::Tensor& tensor, at::IntArrayRef shape, at::ScalarType type,
                  const std::string& what);
/// Copy of a tensor's numbers, row by row.
std::vector<double> to_vector(const at::Tensor& tensor);

}  // namespace lodestone::nets
