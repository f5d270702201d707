#pragma once

#include <ATen/core/Tensor.h>

#include "lodestone/inference/mixture.h"

namespace lodestone::dynamics {

using inference::MixtureLayout;

/// Mean negative log-likelihood of `target` [N, S] under `raw` [N, outputs()], per number, without the
/// constant; and `mean_weight` times the mean squared error of the mixture's mean. Likelihood alone learns
/// slowly where it is wrong at first: it makes the Gaussians wide there, which weakens the pull on their
/// means (Seitzer et al., ICLR 2022).
at::Tensor mixture_loss(const at::Tensor& raw, const at::Tensor& target, const MixtureLayout& layout,
                        double mean_weight = 0.0);

/// Mean of the mixture, [N, S].
at::Tensor mixture_mean(const at::Tensor& raw, const MixtureLayout& layout);

}  // namespace lodestone::dynamics
