#pragma once

#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/inference/array.h"
#include "lodestone/inference/unet_config.h"

namespace lodestone::tests {

/// As small as a segmenter can be.
inline inference::UNetConfig small_unet() { return {/*width=*/4, /*depth=*/2, /*stem=*/4, /*upscale=*/2}; }

/// Weights of a U-Net as drawn from `seed`, by the names of its checkpoint.
inline inference::Arrays drawn_unet_weights(const inference::UNetConfig& config, std::uint64_t seed) {
  common::RandomStream random(seed, "weights");
  inference::Arrays weights;
  const auto add = [&](const std::string& name, const std::vector<std::int64_t>& shape, double low,
                       double high) {
    std::int64_t count = 1;
    for (const std::int64_t side : shape) count *= side;
    std::vector<float> numbers;
    for (std::int64_t i = 0; i < count; ++i) numbers.push_back(static_cast<float>(random.uniform(low, high)));
    weights[name] = inference::Array(std::move(numbers), shape);
  };
  const auto add_unit = [&](const std::string& name, std::int64_t in, std::int64_t out, std::int64_t side) {
    add(name + ".weight", {out, in, side, side}, -0.3, 0.3);
    add(name + "_norm.weight", {out}, 0.5, 1.5);
    add(name + "_norm.bias", {out}, -0.5, 0.5);
    add(name + "_norm.running_mean", {out}, -0.5, 0.5);
    add(name + "_norm.running_var", {out}, 0.5, 1.5);
  };
  add("colour_mean", {1, 3, 1, 1}, 100.0, 150.0);
  add("colour_std", {1, 3, 1, 1}, 40.0, 80.0);
  add_unit("stem", 3, config.width, config.stem + 2 * config.stem_border());
  for (std::int64_t level = 0; level <= config.depth; ++level) {
    const std::int64_t wide = config.width << level;
    add_unit("down" + std::to_string(level) + "a", level == 0 ? wide : wide / 2, wide, 3);
    add_unit("down" + std::to_string(level) + "b", wide, wide, 3);
    if (level == config.depth) break;
    add_unit("up" + std::to_string(level) + "a", 3 * wide, wide, 3);
    add_unit("up" + std::to_string(level) + "b", wide, wide, 3);
  }
  const std::int64_t out = inference::UNetConfig::kClasses * config.upscale * config.upscale;
  add("head.weight", {out, config.width, 1, 1}, -0.3, 0.3);
  add("head.bias", {out}, -4.0, 4.0);
  return weights;
}

}  // namespace lodestone::tests
