#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/nets/parameters.h"

namespace lodestone::nets {

/// y = x W' + b: [N, inputs] -> [N, outputs].
struct Linear {
  /// Adds "<name>.weight" and "<name>.bias", zero.
  Linear(Parameters& tensors, const std::string& name, std::int64_t inputs, std::int64_t outputs);
  /// Draws both by PyTorch's default, uniform within 1 / sqrt(inputs), so that a network depends on the run's
  /// seed alone.
  void initialise(common::RandomStream& random);
  at::Tensor operator()(const at::Tensor& x) const;

  at::Tensor weight, bias;
};

/// Batch normalisation (Ioffe and Szegedy, 2015) with PyTorch's defaults and names: each of `channels` less
/// its mean, by its standard deviation, times weight, plus bias. While training the batch's own statistics,
/// which the running ones then follow.
struct BatchNorm {
  BatchNorm(Parameters& tensors, const std::string& name, std::int64_t channels);
  /// [N, channels] or [N, channels, H, W].
  at::Tensor operator()(const at::Tensor& x, bool training) const;

  at::Tensor weight, bias, running_mean, running_var, batches;
};

/// Fills a tensor with numbers that `draw` gives, rounded to its type.
void fill(at::Tensor& tensor, const std::function<double()>& draw);

}  // namespace lodestone::nets
