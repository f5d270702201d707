#pragma once

#include <ATen/core/Tensor.h>

#include "lodestone/inference/mixture.h"

namespace lodestone::dynamics {

using inference::MixtureLayout;

/// Mean negative log-likelihood of `target` [N, S] under `raw` [N, outputs()], per number, without the
/// constant.
at::Tensor mixture_loss(const at::Tensor& raw, const at::Tensor& target, const MixtureLayout& layout);

/// Mean of the mixture, [N, S].
at::Tensor mixture_mean(const at::Tensor& raw, const MixtureLayout& layout);

}  // namespace lodestone::dynamics
