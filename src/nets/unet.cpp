#include "lodestone/nets/unet.h"

#include <cmath>

#include <ATen/Context.h>
#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>
#include <ATen/ops/cat.h>
#include <ATen/ops/conv2d.h>
#include <ATen/ops/full.h>
#include <ATen/ops/max_pool2d.h>
#include <ATen/ops/mkldnn_convolution.h>
#include <ATen/ops/pixel_shuffle.h>
#include <ATen/ops/upsample_nearest2d.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {

using at::Tensor;

void UNet::add_unit(const std::string& name, std::int64_t in, std::int64_t out, std::int64_t kernel,
                    std::int64_t stride, std::int64_t padding) {
  Convolution& unit = units_.emplace_back();
  unit.stride = stride;
  unit.padding = padding;
  unit.weight = tensors_.add(name + ".weight", {out, in, kernel, kernel});
  if (batch_norm_) {
    unit.norm.emplace(tensors_, name + "_norm", out);
  } else {
    unit.bias = tensors_.add(name + ".bias", {out});
  }
}

UNet::UNet(const UNetConfig& config, bool batch_norm)
    : config_(config),
      batch_norm_(batch_norm),
      colour_mean_(tensors_.add_buffer("colour_mean", at::full({1, 3, 1, 1}, 127.0))),
      colour_std_(tensors_.add_buffer("colour_std", at::full({1, 3, 1, 1}, 64.0))) {
  const std::int64_t stem = config.stem;
  // The patches of the first layer overlap a little, so that edges between them are seen.
  const std::int64_t border = stem > 1 ? 1 : 0;
  add_unit("stem", 3, config.width, stem + 2 * border, stem, border);
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
  const std::int64_t out = kClasses * config.upscale * config.upscale;
  head_ = {tensors_.add("head.weight", {out, channels, 1, 1}), tensors_.add("head.bias", {out}), 1, 0, {}};
}

/// LibTorch gives small and 1x1 convolutions of one image on one thread to a path that copies every patch
/// first; a folded network, which needs no gradients, goes to oneDNN with all of them.
Tensor UNet::convolve(const Convolution& convolution, const Tensor& x) const {
  const auto& [weight, bias, stride, padding, norm] = convolution;
  if (batch_norm_ || !at::globalContext().hasMKLDNN()) return at::conv2d(x, weight, bias, stride, padding);
  return at::mkldnn_convolution(x, weight, bias, {padding, padding}, {stride, stride}, {1, 1}, 1);
}

Tensor UNet::run(const Convolution& unit, const Tensor& x) const {
  Tensor y = convolve(unit, x);
  if (unit.norm) y = (*unit.norm)(y, training_);
  return y.relu_();
}

Tensor UNet::forward(const Tensor& image) const {
  return forward_normalised((image - colour_mean_) / colour_std_);
}

Tensor UNet::forward_normalised(Tensor x) const {
  const std::int64_t multiple = config_.multiple();
  LODESTONE_CHECK(x.dim() == 4 && x.size(1) == 3 && x.size(2) % multiple == 0 && x.size(3) % multiple == 0,
                  "images [N, 3, H, W] with sides that are multiples of " + std::to_string(multiple));
  auto next = units_.begin();
  x = run(*next++, x);
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
  x = convolve(head_, x);
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
  for (Convolution& unit : units_) draw(unit.weight);
  draw(head_.weight);
  // What is looked for is small: the network starts by expecting none of it.
  fill(head_.bias, [] { return -4.0; });
}

std::shared_ptr<UNet> UNet::folded() const {
  const at::NoGradGuard no_grad;
  LODESTONE_CHECK(batch_norm_, "a network that is not folded yet");
  std::shared_ptr<UNet> out(new UNet(config_, /*batch_norm=*/false));
  for (std::size_t i = 0; i < units_.size(); ++i) {
    const BatchNorm& norm = *units_[i].norm;
    const Tensor gain = norm.weight / (norm.running_var + BatchNorm::kEpsilon).sqrt();
    out->units_[i].bias.copy_(norm.bias - norm.running_mean * gain);
    out->units_[i].weight.copy_(units_[i].weight * gain.view({-1, 1, 1, 1}));
  }
  out->head_.weight.copy_(head_.weight);
  out->head_.bias.copy_(head_.bias);
  out->colour_mean_.copy_(colour_mean_);
  out->colour_std_.copy_(colour_std_);
  for (Tensor& parameter : out->tensors_.parameters()) {
    parameter.set_requires_grad(false);
    if (parameter.dim() == 4) parameter.set_data(parameter.contiguous(at::MemoryFormat::ChannelsLast));
  }
  out->train(false);
  return out;
}

}  // namespace lodestone::nets
