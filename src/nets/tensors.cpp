#include "lodestone/nets/tensors.h"

#include <sstream>

#include <torch/types.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {

void check_tensor(const torch::Tensor& tensor, const std::string& name,
                  const std::vector<std::int64_t>& shape, torch::ScalarType type) {
  LODESTONE_CHECK(tensor.defined(), name + " is an undefined tensor");
  bool fits = tensor.scalar_type() == type && tensor.device().is_cpu() && tensor.is_contiguous() &&
              tensor.dim() == static_cast<std::int64_t>(shape.size());
  for (std::size_t d = 0; fits && d < shape.size(); ++d) {
    fits = shape[d] == -1 || shape[d] == tensor.size(static_cast<std::int64_t>(d));
  }
  if (fits) return;
  std::ostringstream message;
  message << name << " must be a contiguous CPU tensor [";
  for (std::size_t d = 0; d < shape.size(); ++d) message << (d ? ", " : "") << shape[d];
  message << "] " << torch::toString(type) << ", not " << tensor.sizes() << " "
          << torch::toString(tensor.scalar_type());
  LODESTONE_CHECK(fits, message.str());
}

torch::Tensor tensor_from(const std::vector<double>& values, const std::vector<std::int64_t>& shape,
                          torch::ScalarType type) {
  torch::Tensor tensor = torch::empty(shape, torch::kFloat64);
  LODESTONE_CHECK(tensor.numel() == static_cast<std::int64_t>(values.size()),
                  "shape does not hold " + std::to_string(values.size()) + " numbers");
  std::copy(values.begin(), values.end(), tensor.data_ptr<double>());
  return tensor.to(type);
}

torch::Tensor tensor_from(const std::vector<std::int64_t>& values) {
  torch::Tensor tensor = torch::empty({static_cast<std::int64_t>(values.size())}, torch::kInt64);
  std::copy(values.begin(), values.end(), tensor.data_ptr<std::int64_t>());
  return tensor;
}

std::vector<double> to_vector(const torch::Tensor& tensor) {
  const torch::Tensor flat = tensor.detach().to(torch::kFloat64).contiguous();
  const double* data = flat.data_ptr<double>();
  return {data, data + flat.numel()};
}

}  // namespace lodestone::nets
