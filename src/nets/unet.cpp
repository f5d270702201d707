#include "lodestone/nets/unet.h"

#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::nets {

using torch::Tensor;

UNetImpl::Unit UNetImpl::make_unit(const std::string& name, std::int64_t in, std::int64_t out,
                                   std::int64_t kernel, std::int64_t stride, std::int64_t padding) {
  Unit unit;
  unit.stride = stride;
  unit.padding = padding;
  unit.convolution = register_module(
      name,
      torch::nn::Conv2d(
          torch::nn::Conv2dOptions(in, out, kernel).stride(stride).padding(padding).bias(!batch_norm_)));
  if (batch_norm_) unit.norm = register_module(name + "_norm", torch::nn::BatchNorm2d(out));
  return unit;
}

UNetImpl::UNetImpl(const UNetConfig& config, std::int64_t classes, bool batch_norm)
    : config_(config), classes_(classes), batch_norm_(batch_norm) {
  colour_mean = register_buffer("colour_mean", torch::full({1, 3, 1, 1}, 127.0));
  colour_std = register_buffer("colour_std", torch::full({1, 3, 1, 1}, 64.0));
  const std::int64_t stem = config.stem;
  // The patches of the first layer overlap a little, so that edges between them are seen.
  const std::int64_t border = stem > 1 ? 1 : 0;
  units_.push_back(make_unit("stem", 3, config.width, stem + 2 * border, stem, border));
  std::int64_t channels = config.width;
  for (std::int64_t level = 0; level <= config.depth; ++level) {
    const std::int64_t wide = config.width << level;
    const std::string name = "down" + std::to_string(level);
    units_.push_back(make_unit(name + "a", channels, wide, 3, 1, 1));
    units_.push_back(make_unit(name + "b", wide, wide, 3, 1, 1));
    channels = wide;
  }
  for (std::int64_t level = config.depth - 1; level >= 0; --level) {
    const std::int64_t wide = config.width << level;
    const std::string name = "up" + std::to_string(level);
    units_.push_back(make_unit(name + "a", channels + wide, wide, 3, 1, 1));
    units_.push_back(make_unit(name + "b", wide, wide, 3, 1, 1));
    channels = wide;
  }
  head_ = register_module("head", torch::nn::Conv2d(torch::nn::Conv2dOptions(
                                      channels, classes * config.upscale * config.upscale, 1)));
}

/// LibTorch gives small and 1x1 convolutions of one image on one thread to a path that copies every patch
/// first; a folded network, which needs no gradients, goes to oneDNN with all of them.
Tensor UNetImpl::convolve(torch::nn::Conv2d& convolution, std::int64_t stride, std::int64_t padding,
                          const Tensor& x) const {
  if (batch_norm_ || !x.device().is_cpu() || !at::globalContext().hasMKLDNN()) return convolution->forward(x);
  return at::mkldnn_convolution(x, convolution->weight, convolution->bias, {padding, padding},
                                {stride, stride}, {1, 1}, 1);
}

Tensor UNetImpl::run(Unit& unit, const Tensor& x) {
  Tensor y = convolve(unit.convolution, unit.stride, unit.padding, x);
  if (batch_norm_) y = unit.norm->forward(y);
  return y.relu_();
}

Tensor UNetImpl::forward(const Tensor& image) {
  return forward_normalised((image - colour_mean) / colour_std);
}

Tensor UNetImpl::forward_normalised(Tensor x) {
  const std::int64_t multiple = config_.multiple();
  LODESTONE_CHECK(x.dim() == 4 && x.size(1) == 3 && x.size(2) % multiple == 0 && x.size(3) % multiple == 0,
                  "images [N, 3, H, W] with sides that are multiples of " + std::to_string(multiple));
  std::size_t next = 0;
  x = run(units_[next++], x);
  std::vector<Tensor> skipped;
  for (std::int64_t level = 0; level <= config_.depth; ++level) {
    if (level > 0) x = torch::max_pool2d(x, 2);
    x = run(units_[next++], x);
    x = run(units_[next++], x);
    if (level < config_.depth) skipped.push_back(x);
  }
  for (std::int64_t level = config_.depth - 1; level >= 0; --level) {
    const Tensor& across = skipped[static_cast<std::size_t>(level)];
    x = torch::upsample_nearest2d(x, {across.size(2), across.size(3)});
    x = run(units_[next++], torch::cat({across, x}, 1));
    x = run(units_[next++], x);
  }
  x = convolve(head_, 1, 0, x);
  return config_.upscale > 1 ? torch::pixel_shuffle(x, config_.upscale) : x;
}

void UNetImpl::fit_normaliser(const Tensor& images) {
  const torch::NoGradGuard no_grad;
  const Tensor values = images.to(torch::kFloat64).transpose(0, 1).flatten(1);
  colour_mean.copy_(values.mean(1).view({1, 3, 1, 1}));
  colour_std.copy_(values.std(1).clamp_min(1.0).view({1, 3, 1, 1}));
}

void UNetImpl::initialise(common::RandomStream& random) {
  const torch::NoGradGuard no_grad;
  for (const auto& child : modules()) {
    auto* convolution = child->as<torch::nn::Conv2d>();
    if (convolution == nullptr) continue;
    const Tensor& weight = convolution->weight;
    const double spread = std::sqrt(2.0 / static_cast<double>(weight[0].numel()));
    Tensor values = torch::empty(weight.sizes(), torch::kFloat64);
    double* data = values.data_ptr<double>();
    for (std::int64_t i = 0; i < values.numel(); ++i) data[i] = spread * random.normal();
    convolution->weight.copy_(values);
    if (convolution->bias.defined()) convolution->bias.zero_();
  }
  // What is looked for is small: the network starts by expecting none of it.
  head_->bias.fill_(-4.0);
}

/// Reaches into both networks.
class UNetFolder {
 public:
  static UNet fold(UNetImpl& network) {
    const torch::NoGradGuard no_grad;
    LODESTONE_CHECK(network.batch_norm_, "a network that is not folded yet");
    UNet out(network.config_, network.classes_, /*batch_norm=*/false);
    for (std::size_t i = 0; i < network.units_.size(); ++i) {
      const UNetImpl::Unit& from = network.units_[i];
      const torch::nn::BatchNorm2d& norm = from.norm;
      const Tensor gain = norm->weight / (norm->running_var + norm->options.eps()).sqrt();
      Tensor weight = from.convolution->weight * gain.view({-1, 1, 1, 1});
      out->units_[i].convolution->bias.copy_(norm->bias - norm->running_mean * gain);
      out->units_[i].convolution->weight.copy_(weight);
    }
    out->head_->weight.copy_(network.head_->weight);
    out->head_->bias.copy_(network.head_->bias);
    out->colour_mean.copy_(network.colour_mean);
    out->colour_std.copy_(network.colour_std);
    for (Tensor& parameter : out->parameters()) {
      parameter.set_requires_grad(false);
      if (parameter.dim() == 4) parameter.set_data(parameter.contiguous(torch::MemoryFormat::ChannelsLast));
    }
    out->eval();
    return out;
  }
};

UNet folded(UNet& network) { return UNetFolder::fold(*network); }

}  // namespace lodestone::nets
