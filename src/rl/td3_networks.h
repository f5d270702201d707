#pragma once

#include <array>
#include <cstdint>

#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/td3_config.h"

namespace lodestone::rl {

/// A network while it learns, with its target, which follows it slowly, and Adam's moments.
template <class Real>
struct Learner {
  explicit Learner(FlatNetwork<Real> drawn);
  /// Adam's step `step` (from 1) on numbers [begin, end) of the parameters; `gradient` is laid out like them.
  void adam(const at::Tensor& gradient, double learning_rate, std::int64_t step, std::int64_t begin,
            std::int64_t end);
  /// The target's step on numbers [begin, end).
  void polyak(double tau, std::int64_t begin, std::int64_t end);
  std::int64_t size() const { return first_moment.numel(); }

  FlatNetwork<Real> network, target;
  at::Tensor first_moment, second_moment;
};

/// The networks of one TD3 as drawn from a seed, each from its own random stream: where every backend starts.
template <class Real>
struct Td3Networks {
  Td3Networks(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
              std::uint64_t seed);
  /// Views by the names of Td3::networks() and Td3::optimiser().
  nets::NamedTensors networks() const;
  nets::NamedTensors optimiser() const;

  Learner<Real> actor;                   ///< D -> hidden -> A, before tanh
  std::array<Learner<Real>, 2> critics;  ///< D + A -> hidden -> 1

 private:
  std::array<int, 2> first_layer_;  // number of each critic's first layer in its names
};

extern template struct Learner<float>;
extern template struct Learner<double>;
extern template struct Td3Networks<float>;
extern template struct Td3Networks<double>;

}  // namespace lodestone::rl
