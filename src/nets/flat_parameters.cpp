#include "lodestone/nets/flat_parameters.h"

#include <torch/nn/module.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {

FlatParameters::FlatParameters(torch::nn::Module& module) {
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> parameters = module.parameters();
  std::int64_t count = 0;
  for (const torch::Tensor& parameter : parameters) {
    LODESTONE_CHECK(parameter.scalar_type() == torch::kFloat32, "flat parameters must be float32");
    count += parameter.numel();
  }
  LODESTONE_CHECK(count > 0, "the module has no parameters");
  values_ = torch::empty({count});
  gradient_ = torch::zeros({count});
  std::int64_t offset = 0;
  for (torch::Tensor& parameter : parameters) {
    torch::Tensor view = values_.narrow(0, offset, parameter.numel()).view(parameter.sizes());
    view.copy_(parameter);
    parameter.set_data(view);
    parameter.mutable_grad() = gradient_.narrow(0, offset, parameter.numel()).view(parameter.sizes());
    offset += parameter.numel();
  }
}

}  // namespace lodestone::nets
