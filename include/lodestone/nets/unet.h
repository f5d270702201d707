#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/nets/layers.h"
#include "lodestone/nets/parameters.h"
#include "lodestone/nets/unet_config.h"

namespace lodestone::nets {

/// U-Net (Ronneberger, Fischer, Brox, 2015) with a strided first layer and a sub-pixel last one (Shi et al.,
/// 2016), because the needle is thin and the crop has to be segmented in a few milliseconds. Every level is
/// two 3x3 convolutions with batch normalisation and ReLU. The colour normaliser is a pair of buffers.
class UNet {
 public:
  static constexpr std::int64_t kClasses = 2;

  explicit UNet(const UNetConfig& config) : UNet(config, /*batch_norm=*/true) {}
  UNet(const UNet&) = delete;
  UNet& operator=(const UNet&) = delete;

  /// [N, 3, H, W] float32, BGR in 0..255, H and W multiples of config().multiple() -> logits
  /// [N, kClasses, H * upscale / stem, W * upscale / stem].
  at::Tensor forward(const at::Tensor& image) const;
  /// The same from (image - colour_mean) / colour_std.
  at::Tensor forward_normalised(at::Tensor x) const;
  /// Whether batches are normalised by their own statistics, which then move the running ones. At first so.
  void train(bool training) { training_ = training; }

  /// Mean and standard deviation of each colour over training images [N, 3, H, W].
  void fit_normaliser(const at::Tensor& images);
  /// He's initialisation, from `random` alone; masks begin nearly empty.
  void initialise(common::RandomStream& random);

  /// The same function in evaluation mode, with every batch normalisation folded into its convolution.
  std::shared_ptr<UNet> folded() const;

  const UNetConfig& config() const { return config_; }
  Parameters& tensors() { return tensors_; }
  const Parameters& tensors() const { return tensors_; }
  const at::Tensor& colour_mean() const { return colour_mean_; }  ///< [1, 3, 1, 1]
  const at::Tensor& colour_std() const { return colour_std_; }

 private:
  struct Convolution {
    at::Tensor weight, bias;  // no bias where batch normalisation follows
    std::int64_t stride, padding;
    std::optional<BatchNorm> norm;
  };

  UNet(const UNetConfig& config, bool batch_norm);
  void add_unit(const std::string& name, std::int64_t in, std::int64_t out, std::int64_t kernel,
                std::int64_t stride, std::int64_t padding);
  at::Tensor convolve(const Convolution& convolution, const at::Tensor& x) const;
  at::Tensor run(const Convolution& unit, const at::Tensor& x) const;

  UNetConfig config_;
  bool batch_norm_;
  bool training_ = true;
  Parameters tensors_;
  at::Tensor colour_mean_, colour_std_;  ///< buffers
  std::vector<Convolution> units_;       ///< stem, then two a level down, then two a level up
  Convolution head_;
};

}  // namespace lodestone::nets
