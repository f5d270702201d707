#include "td3_networks.h"

#include <utility>
#include <vector>

namespace lodestone::rl {
namespace {

std::vector<std::int64_t> network_widths(std::int64_t in, const std::vector<std::int64_t>& hidden,
                                         std::int64_t out) {
  std::vector<std::int64_t> widths{in};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  widths.push_back(out);
  return widths;
}

template <class Real>
FlatNetwork<Real> drawn_network(std::vector<std::int64_t> widths, std::uint64_t seed, const char* name,
                                std::uint64_t index) {
  FlatNetwork<Real> network(std::move(widths));
  common::RandomStream random(seed, name, index);
  network.initialise(random);
  return network;
}

}  // namespace

template <class Real>
Td3Networks<Real>::Td3Networks(const Td3Config& config, std::int64_t observation_size,
                               std::int64_t action_size, std::uint64_t seed)
    : actor(drawn_network<Real>(network_widths(observation_size, config.hidden, action_size), seed, "actor",
                                0)),
      critics{drawn_network<Real>(network_widths(observation_size + action_size, config.hidden, 1), seed,
                                  "critic", 0),
              drawn_network<Real>(network_widths(observation_size + action_size, config.hidden, 1), seed,
                                  "critic", 1)} {}

template struct Td3Networks<float>;
template struct Td3Networks<double>;

}  // namespace lodestone::rl
