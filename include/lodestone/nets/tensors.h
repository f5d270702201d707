#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

namespace lodestone::nets {

/// Throws LogicFault naming `name` unless `tensor` is defined, of `type`, on the CPU, contiguous, and of
/// `shape`
/// (-1 fits any size).
void check_tensor(const at::Tensor& tensor, const std::string& name, const std::vector<std::int64_t>& shape,
                  at::ScalarType type);

/// Copy of numbers as a tensor of `type` and `shape`.
at::Tensor tensor_from(const std::vector<double>& values, const std::vector<std::int64_t>& shape,
                       at::ScalarType type = at::kDouble);
at::Tensor tensor_from(const std::vector<std::int64_t>& values);

/// Copy of a tensor's numbers, row by row.
std::vector<double> to_vector(const at::Tensor& tensor);

}  // namespace lodestone::nets
