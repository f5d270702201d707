#pragma once

#include <cstddef>
#include <cstdint>

namespace lodestone::nets {

/// One Adam step over `count` contiguous numbers (Kingma and Ba, 2015; betas 0.9 and 0.999, epsilon 1e-8),
/// the same arithmetic as torch::optim::Adam. `step` counts from 1. Real is float or double.
template <class Real>
void adam_step(Real* parameters, const Real* gradient, Real* first_moment, Real* second_moment,
               std::size_t count, double learning_rate, std::int64_t step);

/// One step of gradient descent with momentum: velocity = momentum * velocity + gradient, and the parameters
/// less learning_rate * velocity.
void momentum_step(float* parameters, const float* gradient, float* velocity, std::size_t count,
                   double learning_rate, double momentum);

/// target += scale * source.
void add_scaled(float* target, const float* source, std::size_t count, double scale);

/// Polyak averaging: target += tau * (source - target), as tau * source + (1 - tau) * target.
template <class Real>
void polyak_step(Real* target, const Real* source, std::size_t count, double tau);

}  // namespace lodestone::nets
