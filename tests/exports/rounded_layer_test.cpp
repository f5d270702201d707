#include "rounded_layer.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "exports/policies.h"

using namespace lodestone;
using exports::PolicyContract;
using exports::RoundedLayer;

TEST_CASE("a rounded layer has 16 bits of the largest weight of each row", "[unit]") {
  const PolicyContract contract(tests::untrained_policy({}));
  const std::vector<RoundedLayer> layers = rounded_layers(contract);
  REQUIRE(layers.size() == 3);
  CHECK(layers[0].inputs == task::ObservationEncoder(contract.policy().encoder).size());
  CHECK(layers[2].outputs == 2);
  CHECK(exports::products(layers) == layers[0].inputs * 16 + 16 * 12 + 12 * 2);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const RoundedLayer& layer = layers[i];
    const std::vector<float> exact = contract.weights("l" + std::to_string(i + 1) + ".weight");
    CHECK(layer.bias == contract.weights("l" + std::to_string(i + 1) + ".bias"));
    for (std::size_t row = 0; row < layer.scale.size(); ++row) {
      std::int16_t largest = 0;
      for (std::size_t j = row * static_cast<std::size_t>(layer.inputs);
           j < (row + 1) * static_cast<std::size_t>(layer.inputs); ++j) {
        largest = std::max<std::int16_t>(largest, static_cast<std::int16_t>(std::abs(layer.weight[j])));
        CHECK(std::abs(exact[j] - layer.scale[row] * layer.weight[j]) < 0.51F * layer.scale[row]);
      }
      CHECK(largest == 32767);
    }
  }
}

TEST_CASE("a row of zeros stays one", "[unit]") {
  inference::Policy policy = tests::untrained_policy({});
  std::vector<float> weight = policy.weights.at("l3.weight").to_vector<float>();
  std::fill(weight.begin(), weight.begin() + 12, 0.0F);
  policy.weights["l3.weight"] = {weight, {2, 12}};
  const PolicyContract contract(policy);
  const std::vector<float> rounded =
      rounded_policy(policy, rounded_layers(contract)).weights.at("l3.weight").to_vector<float>();
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    if (i < 12)
      CHECK(rounded[i] == 0.0F);
    else
      CHECK(rounded[i] == Approx(weight[i]).margin(1e-4));
  }
}
