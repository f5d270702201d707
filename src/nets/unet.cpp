#include "lodestone/nets/unet.h"

#include <cmath>

#include <ATen/TensorOperators.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/conv2d.h>
#include <ATen/ops/full.h>
#include <ATen/ops/max_pool2d.h>
#include <ATen/ops/pixel_shuffle.h>
#include <ATen/ops/upsample_nearest2d.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {

using at::Tensor;

void UNet::add_unit(const std::string& name, std::int64_t in, std::int64_t out, std::int64_t kernel,
                    std::int64_t stride, std::int64_t padding) {
  const Tensor weight = tensors_.add(name + ".weight", {out, in, kernel, kernel});
  units_.push_back({weight, stride, padding, BatchNorm(tensors_, name + "_norm", out)});
}

UNet::UNet(const inference::UNetConfig& config)
    : config_(config),
      colour_mean_(tensors_.add_buffer("colour_mean", at::full({1, 3, 1, 1}, 127.0))),
      colour_std_(tensors_.add_buffer("colour_std", at::full({1, 3, 1, 1}, 64.0))) {
  const std::int64_t border = config.stem_border();
  add_unit("stem", 3, config.width, config.stem + 2 * border, config.stem, border);
  std::int64_t channels = config.width;
  for (std::int64_t level = 0; level <= config.depth; ++level) {
    const std::int64_t wide = config.width << level;
    const std::string name = "down" + std::to_string(level);
    add_unit(name + "a", channels, wide, 3, 1, 1);
    add_unit(name + "b", wide, wide, 3, 1, 1);
    channels = wide;
  }
  for (std::int64_t level = config.depth - 1; level >= 0; --level) {
    const std::int64_t wide = config.width << level;
    const std::string name = "up" + std::to_string(level);
    add_unit(name + "a", channels + wide, wide, 3, 1, 1);
    add_unit(name + "b", wide, wide, 3, 1, 1);
    channels = wide;
  }
  const std::int64_t out = inference::UNetConfig::kClasses * config.upscale * config.upscale;
  head_weight_ = tensors_.add("head.weight", {out, channels, 1, 1});
  head_bias_ = tensors_.add("head.bias", {out});
}

Tensor UNet::run(const Unit& unit, const Tensor& x) const {
  return unit.norm(at::conv2d(x, unit.weight, {}, unit.stride, unit.padding), training_).relu_();
}

Tensor UNet::forward(const Tensor& image) const {
  const std::int64_t multiple = config_.multiple();
  LODESTONE_CHECK(image.dim() == 4 && image.size(1) == 3 && image.size(2) % multiple == 0 &&
                      image.size(3) % multiple == 0,
                  "images [N, 3, H, W] with sides that are multiples of " + std::to_string(multiple));
  auto next = units_.begin();
  Tensor x = run(*next++, (image - colour_mean_) / colour_std_);
  std::vector<Tensor> skipped;
  for (std::int64_t level = 0; level <= config_.depth; ++level) {
    if (level > 0) x = at::max_pool2d(x, 2);
    x = run(*next++, x);
    x = run(*next++, x);
    if (level < config_.depth) skipped.push_back(x);
  }
  for (std::int64_t level = config_.depth - 1; level >= 0; --level) {
    const Tensor& across = skipped[static_cast<std::size_t>(level)];
    x = at::upsample_nearest2d(x, {across.size(2), across.size(3)});
    x = run(*next++, at::cat({across, x}, 1));
    x = run(*next++, x);
  }
  x = at::conv2d(x, head_weight_, head_bias_);
  return config_.upscale > 1 ? at::pixel_shuffle(x, config_.upscale) : x;
}

void UNet::fit_normaliser(const Tensor& images) {
  const Tensor values = images.to(at::kDouble).transpose(0, 1).flatten(1);
  colour_mean_.copy_(values.mean(1).view({1, 3, 1, 1}));
  colour_std_.copy_(values.std(1).clamp_min(1.0).view({1, 3, 1, 1}));
}

void UNet::initialise(common::RandomStream& random) {
  const auto draw = [&](Tensor& weight) {
    const double spread =
        std::sqrt(2.0 * static_cast<double>(weight.size(0)) / static_cast<double>(weight.numel()));
    fill(weight, [&] { return spread * random.normal(); });
  };
  for (Unit& unit : units_) draw(unit.weight);
  draw(head_weight_);
  // What is looked for is small: the network starts by expecting none of it.
  fill(head_bias_, [] { return -4.0; });
}

}  // namespace lodestone::nets
