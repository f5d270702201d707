#include "lodestone/inference/unet.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/inference/batch_norm.h"
#include "lodestone/inference/dense_network.h"

namespace lodestone::inference {
namespace {

/// Reads the convolutions of a network one after the other.
class Reader {
 public:
  Reader(const Arrays& weights, const std::string& what) : weights_(weights), what_(what) {}

  const float* at(const std::string& name, const std::vector<std::int64_t>& shape) const {
    return weight_at(weights_, name, shape, what_).data<float>();
  }

  /// A convolution with the batch normalisation that follows it in one, and a ReLU.
  Convolution unit(const std::string& name, std::int64_t channels, std::int64_t outputs, std::int64_t side,
                   Stride stride) const {
    const float* from = at(name + ".weight", {outputs, channels, side, side});
    const auto norm = [&](const char* part) { return at(name + "_norm." + part, {outputs}); };
    const float *gain = norm("weight"), *shift = norm("bias");
    const float *mean = norm("running_mean"), *variance = norm("running_var");
    const std::int64_t covered = channels * side * side;
    std::vector<float> weight(from, from + outputs * covered);
    std::vector<float> bias;
    for (std::int64_t output = 0; output < outputs; ++output) {
      if (!(variance[output] >= 0.0F))
        throw common::CheckpointError(what_ + ": array \"" + name + "_norm.running_var\" holds " +
                                      std::to_string(variance[output]) + ", which is no variance");
      const float scale = gain[output] / std::sqrt(variance[output] + static_cast<float>(kBatchNormEpsilon));
      bias.push_back(shift[output] - mean[output] * scale);
      float* row = weight.data() + output * covered;
      std::transform(row, row + covered, row, [scale](float w) { return w * scale; });
    }
    return Convolution(weight, std::move(bias), side, stride, /*relu=*/true);
  }

  Convolution head(std::int64_t channels, std::int64_t outputs) const {
    const float* weight = at("head.weight", {outputs, channels, 1, 1});
    const float* bias = at("head.bias", {outputs});
    return Convolution({weight, weight + outputs * channels}, {bias, bias + outputs}, 1, {}, /*relu=*/false);
  }

 private:
  const Arrays& weights_;
  const std::string& what_;
};

}  // namespace

UNet::UNet(const UNetConfig& config, const Arrays& weights, const std::string& what) : config_(config) {
  const Reader reader(weights, what);
  const float* mean = reader.at("colour_mean", {1, 3, 1, 1});
  const float* spread = reader.at("colour_std", {1, 3, 1, 1});
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(spread[c] > 0.0F))
      throw common::CheckpointError(what + ": array \"colour_std\" holds a spread that is not above 0");
    gain_[c] = 1.0F / spread[c];
    offset_[c] = -mean[c] / spread[c];
  }
  const std::int64_t border = config.stem_border();
  units_.push_back(reader.unit("stem", 3, config.width, config.stem + 2 * border, {config.stem, border}));
  std::int64_t channels = config.width;
  const auto add_level = [&](const std::string& name, std::int64_t taken, std::int64_t wide) {
    units_.push_back(reader.unit(name + "a", taken, wide, 3, {1, 1}));
    units_.push_back(reader.unit(name + "b", wide, wide, 3, {1, 1}));
    channels = wide;
  };
  for (std::int64_t level = 0; level <= config.depth; ++level)
    add_level("down" + std::to_string(level), channels, config.width << level);
  for (std::int64_t level = config.depth - 1; level >= 0; --level)
    add_level("up" + std::to_string(level), channels + (config.width << level), config.width << level);
  units_.push_back(reader.head(channels, UNetConfig::kClasses * config.upscale * config.upscale));
}

void UNet::normalise(const std::uint8_t* image, std::int64_t height, std::int64_t width,
                     FeatureMap& out) const {
  float* to = out.resize(height, width, 3);
  for (std::int64_t i = 0; i < 3 * height * width; i += 3)
    for (std::size_t c = 0; c < 3; ++c)
      to[static_cast<std::size_t>(i) + c] =
          static_cast<float>(image[static_cast<std::size_t>(i) + c]) * gain_[c] + offset_[c];
}

/// Sub-pixels are channels of the last layer: class, row, column.
void UNet::enlarge(const FeatureMap& head, float* logits) const {
  const std::int64_t upscale = config_.upscale;
  for (std::int64_t of_class = 0; of_class < UNetConfig::kClasses; ++of_class)
    for (std::int64_t y = 0; y < head.height() * upscale; ++y) {
      const float* from = head.row(y / upscale) + (of_class * upscale + y % upscale) * upscale;
      for (std::int64_t x = 0; x < head.width(); ++x, from += head.channels())
        logits = std::copy_n(from, upscale, logits);
    }
}

void UNet::forward(const std::uint8_t* image, std::int64_t height, std::int64_t width, float* logits,
                   Workspace& workspace) const {
  LODESTONE_CHECK(
      height > 0 && width > 0 && height % config_.multiple() == 0 && width % config_.multiple() == 0,
      "an image with sides that are multiples of " + std::to_string(config_.multiple()));
  auto& [across, from, to, joined, lines] = workspace;
  across.resize(static_cast<std::size_t>(config_.depth));
  auto unit = units_.begin();
  normalise(image, height, width, joined);
  (unit++)->run(joined, from, lines);
  for (FeatureMap& kept : across) {
    (unit++)->run(from, to, lines);
    (unit++)->run(to, kept, lines);
    halve(kept, from);
  }
  (unit++)->run(from, to, lines);
  (unit++)->run(to, from, lines);
  for (auto kept = across.rbegin(); kept != across.rend(); ++kept) {
    double_beside(*kept, from, joined);
    (unit++)->run(joined, to, lines);
    (unit++)->run(to, from, lines);
  }
  unit->run(from, to, lines);
  enlarge(to, logits);
}

}  // namespace lodestone::inference
