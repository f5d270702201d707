#pragma once

#include <array>
#include <cstdint>

#include "lodestone/rl/flat_network.h"
#include "lodestone/rl/td3.h"

namespace lodestone::rl {

/// The networks of one TD3 as drawn from a seed, each from its own random stream: where every backend starts.
template <class Real>
struct Td3Networks {
  Td3Networks(const Td3Config& config, std::int64_t observation_size, std::int64_t action_size,
              std::uint64_t seed);
  FlatNetwork<Real> actor;                   ///< D -> hidden -> A, before tanh
  std::array<FlatNetwork<Real>, 2> critics;  ///< D + A -> hidden -> 1
};

extern template struct Td3Networks<float>;
extern template struct Td3Networks<double>;

}  // namespace lodestone::rl
