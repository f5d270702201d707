#include "lodestone/nets/layers.h"

#include <algorithm>
#include <cmath>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/batch_norm.h>
#include <ATen/ops/empty.h>
#include <ATen/ops/linear.h>
#include <ATen/ops/ones.h>
#include <ATen/ops/zeros.h>

#include "lodestone/inference/batch_norm.h"

namespace lodestone::nets {

void fill(at::Tensor& tensor, const std::function<double()>& draw) {
  const at::NoGradGuard no_grad;
  const at::Tensor values = at::empty(tensor.sizes(), at::kDouble);
  std::generate_n(values.data_ptr<double>(), values.numel(), draw);
  tensor.copy_(values);
}

Linear::Linear(Parameters& tensors, const std::string& name, std::int64_t inputs, std::int64_t outputs)
    : weight(tensors.add(name + ".weight", {outputs, inputs})),
      bias(tensors.add(name + ".bias", {outputs})) {}

void Linear::initialise(common::RandomStream& random) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(weight.size(1)));
  for (at::Tensor* tensor : {&weight, &bias}) fill(*tensor, [&] { return random.uniform(-bound, bound); });
}

at::Tensor Linear::operator()(const at::Tensor& x) const { return at::linear(x, weight, bias); }

BatchNorm::BatchNorm(Parameters& tensors, const std::string& name, std::int64_t channels)
    : weight(tensors.add(name + ".weight", {channels})),
      bias(tensors.add(name + ".bias", {channels})),
      running_mean(tensors.add_buffer(name + ".running_mean", at::zeros({channels}))),
      running_var(tensors.add_buffer(name + ".running_var", at::ones({channels}))),
      batches(tensors.add_buffer(name + ".num_batches_tracked", at::zeros({}, at::kLong))) {
  const at::NoGradGuard no_grad;
  weight.fill_(1.0);
}

at::Tensor BatchNorm::operator()(const at::Tensor& x, bool training) const {
  constexpr double kMomentum = 0.1;
  if (training) batches.add_(1);
  return at::batch_norm(x, weight, bias, running_mean, running_var, training, kMomentum,
                        inference::kBatchNormEpsilon,
                        /*cudnn_enabled=*/false);
}

}  // namespace lodestone::nets
