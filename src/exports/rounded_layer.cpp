#include "rounded_layer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lodestone::exports {
namespace {

constexpr float kMostWeight = 32767.0F;

RoundedLayer rounded(const std::vector<float>& weight, const std::vector<float>& bias) {
  RoundedLayer layer;
  layer.bias = bias;
  layer.outputs = static_cast<std::int64_t>(bias.size());
  layer.inputs = static_cast<std::int64_t>(weight.size()) / layer.outputs;
  for (auto row = weight.begin(); row != weight.end(); row += layer.inputs) {
    const float largest = std::accumulate(row, row + layer.inputs, 0.0F, [](float most, float number) {
      return std::max(most, std::abs(number));
    });
    const float scale = largest / kMostWeight;
    layer.scale.push_back(scale);
    std::for_each(row, row + layer.inputs, [&](float number) {
      const float whole = scale > 0.0F ? std::round(number / scale) : 0.0F;
      layer.weight.push_back(static_cast<std::int16_t>(std::clamp(whole, -kMostWeight, kMostWeight)));
    });
  }
  return layer;
}

}  // namespace

std::vector<RoundedLayer> rounded_layers(const PolicyContract& contract) {
  std::vector<RoundedLayer> layers;
  for (std::size_t i = 1; i <= contract.layers(); ++i) {
    const std::string name = "l" + std::to_string(i);
    layers.push_back(rounded(contract.weights(name + ".weight"), contract.weights(name + ".bias")));
  }
  return layers;
}

std::int64_t products(const std::vector<RoundedLayer>& layers) {
  return std::accumulate(
      layers.begin(), layers.end(), std::int64_t{0},
      [](std::int64_t sum, const RoundedLayer& layer) { return sum + layer.inputs * layer.outputs; });
}

inference::Policy rounded_policy(const inference::Policy& policy, const std::vector<RoundedLayer>& layers) {
  inference::Policy rounded = policy;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const RoundedLayer& layer = layers[i];
    std::vector<float> weight(layer.weight.begin(), layer.weight.end());
    for (std::size_t j = 0; j < weight.size(); ++j)
      weight[j] *= layer.scale[j / static_cast<std::size_t>(layer.inputs)];
    rounded.weights["l" + std::to_string(i + 1) + ".weight"] = {weight, {layer.outputs, layer.inputs}};
  }
  return rounded;
}

}  // namespace lodestone::exports
