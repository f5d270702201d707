#pragma once

#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/inference/policy.h"

namespace lodestone::tests {

inline inference::Array random_array(const std::vector<std::int64_t>& shape, common::RandomStream& random) {
  std::size_t count = 1;
  for (const std::int64_t length : shape) count *= static_cast<std::size_t>(length);
  std::vector<float> numbers(count);
  for (float& number : numbers) number = static_cast<float>(random.uniform(-0.5, 0.5));
  return {std::move(numbers), shape};
}

/// Gives `policy` a network with random weights that fits its encoder and hidden layers, and the paper's dish
/// and current where it has none.
inline void draw_weights(inference::Policy& policy, std::uint64_t seed) {
  if (policy.encoder.length_scale_m == 0.0) policy.encoder.length_scale_m = 0.0425;
  if (policy.action.scale == 0.0) policy.action.scale = 15.0;
  std::vector<std::int64_t> widths = {task::ObservationEncoder(policy.encoder).size()};
  widths.insert(widths.end(), policy.hidden.begin(), policy.hidden.end());
  widths.push_back(inference::Actor::outputs(2, policy.proposals));
  common::RandomStream random(seed, "policy");
  for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
    const std::string name = "l" + std::to_string(i + 1);
    policy.weights[name + ".weight"] = random_array({widths[i + 1], widths[i]}, random);
    policy.weights[name + ".bias"] = random_array({widths[i + 1]}, random);
  }
}

}  // namespace lodestone::tests
