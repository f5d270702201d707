#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <torch/torch.h>

namespace lodestone::nets {

/// Throws LogicFault naming `name` unless `tensor` is defined, of `type`, on the CPU, contiguous, and of
/// `shape`
/// (-1 fits any size).
void check_tensor(const torch::Tensor& tensor, const std::string& name,
                  const std::vector<std::int64_t>& shape, torch::ScalarType type);

/// Copy of numbers as a tensor of `type` and `shape`.
torch::Tensor tensor_from(const std::vector<double>& values, const std::vector<std::int64_t>& shape,
                          torch::ScalarType type = torch::kFloat64);
torch::Tensor tensor_from(const std::vector<std::int64_t>& values);

/// Copy of a tensor's numbers, row by row.
std::vector<double> to_vector(const torch::Tensor& tensor);

}  // namespace lodestone::nets
