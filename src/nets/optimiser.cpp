#include "lodestone/nets/optimiser.h"

#include <cmath>

namespace lodestone::nets {

template <class Real>
void adam_step(Real* __restrict parameters, const Real* __restrict gradient, Real* __restrict first_moment,
               Real* __restrict second_moment, std::size_t count, double learning_rate, std::int64_t step) {
  constexpr double kBeta1 = 0.9;
  constexpr double kBeta2 = 0.999;
  const double correction1 = 1.0 - std::pow(kBeta1, static_cast<double>(step));
  const double correction2 = 1.0 - std::pow(kBeta2, static_cast<double>(step));
  const auto beta1 = static_cast<Real>(kBeta1);
  const auto beta2 = static_cast<Real>(kBeta2);
  const auto rest1 = static_cast<Real>(1.0 - kBeta1);
  const auto rest2 = static_cast<Real>(1.0 - kBeta2);
  const auto root2 = static_cast<Real>(1.0 / std::sqrt(correction2));
  const auto rate = static_cast<Real>(learning_rate / correction1);
  const auto epsilon = static_cast<Real>(1e-8);
  for (std::size_t i = 0; i < count; ++i) {
    const Real g = gradient[i];
    const Real m = beta1 * first_moment[i] + rest1 * g;
    const Real v = beta2 * second_moment[i] + rest2 * g * g;
    first_moment[i] = m;
    second_moment[i] = v;
    parameters[i] -= rate * m / (std::sqrt(v) * root2 + epsilon);
  }
}

void momentum_step(float* __restrict parameters, const float* __restrict gradient, float* __restrict velocity,
                   std::size_t count, double learning_rate, double momentum) {
  const auto keep = static_cast<float>(momentum);
  for (std::size_t i = 0; i < count; ++i) velocity[i] = keep * velocity[i] + gradient[i];
  add_scaled(parameters, velocity, count, -learning_rate);
}

void add_scaled(float* __restrict target, const float* __restrict source, std::size_t count, double scale) {
  const auto factor = static_cast<float>(scale);
  for (std::size_t i = 0; i < count; ++i) target[i] += factor * source[i];
}

template <class Real>
void polyak_step(Real* __restrict target, const Real* __restrict source, std::size_t count, double tau) {
  const auto take = static_cast<Real>(tau);
  const auto keep = static_cast<Real>(1.0 - tau);
  for (std::size_t i = 0; i < count; ++i) target[i] = take * source[i] + keep * target[i];
}

template void adam_step(float*, const float*, float*, float*, std::size_t, double, std::int64_t);
template void adam_step(double*, const double*, double*, double*, std::size_t, double, std::int64_t);
template void polyak_step(float*, const float*, std::size_t, double);
template void polyak_step(double*, const double*, std::size_t, double);

}  // namespace lodestone::nets
