#pragma once

#include <cstddef>
#include <cstdint>

namespace lodestone::rl {

/// One Adam step over `count` contiguous numbers (Kingma and Ba, 2015; betas 0.9 and 0.999, epsilon 1e-8),
/// the same arithmetic as torch::optim::Adam. `step` counts from 1.
void adam_step(float* parameters, const float* gradient, float* first_moment, float* second_moment,
               std::size_t count, double learning_rate, std::int64_t step);
void adam_step(double* parameters, const double* gradient, double* first_moment, double* second_moment,
               std::size_t count, double learning_rate, std::int64_t step);

/// Polyak averaging: target += tau * (source - target), as tau * source + (1 - tau) * target.
void polyak_step(float* target, const float* source, std::size_t count, double tau);
void polyak_step(double* target, const double* source, std::size_t count, double tau);

}  // namespace lodestone::rl
