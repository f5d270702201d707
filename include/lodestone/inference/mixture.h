#pragma once

#include <array>
#include <cstdint>

#include "lodestone/common/random.h"

namespace lodestone::inference {

/// A mixture of K Gaussians with diagonal covariance over S numbers, as the last layer of a network gives it:
/// [K logits of the weights][K x S means][K x S raw spreads]. One component may sit on "did not move" while
/// the others spread over how far: what stick-slip does, and what a mean hides (Bishop, Mixture density
/// networks, 1994).
struct MixtureLayout {
  std::int64_t components = 1;
  std::int64_t size = 1;

  std::int64_t outputs() const { return components * (1 + 2 * size); }
};

/// Bounds of a logarithm of a standard deviation, in units of the normalised output; a raw spread is squeezed
/// between them, so that neither a likelihood nor a sample can run away.
constexpr double kLeastLogSpread = -5.5;
constexpr double kMostLogSpread = 1.5;

/// Mean of the mixture that one row of floats describes: writes S numbers.
void mixture_mean(const float* raw, const MixtureLayout& layout, float* out);
/// Natural logarithm of the mixture's density at `value` [S], where a value is only known with independent
/// normal errors of `noise` [S].
double mixture_log_density(const float* raw, const MixtureLayout& layout, const double* value,
                           const double* noise);
/// The random numbers behind one draw: a uniform one that chooses the component, and a normal one for each of
/// at most three numbers.
struct Luck {
  static Luck draw(std::int64_t size, common::RandomStream& random);
  double uniform = 0.0;
  std::array<double, 3> normal{};
};
/// The components' weights [K], which add up to 1, and the standard deviation that a raw spread stands for.
void mixture_weights(const float* raw, const MixtureLayout& layout, float* out);
double mixture_spread(float raw);
/// One draw: writes S numbers.
void mixture_draw(const float* raw, const MixtureLayout& layout, const Luck& luck, float* out);

}  // namespace lodestone::inference
