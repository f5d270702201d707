#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <ATen/core/Tensor.h>

#include "lodestone/common/random.h"
#include "lodestone/inference/unet_config.h"
#include "lodestone/nets/layers.h"
#include "lodestone/nets/parameters.h"

namespace lodestone::nets {

/// U-Net (Ronneberger, Fischer, Brox, 2015) with a strided first layer and a sub-pixel last one (Shi et al.,
/// 2016), because the needle is thin and the crop has to be segmented in a few milliseconds. Every level is
/// two 3x3 convolutions with batch normalisation and ReLU. The colour normaliser is a pair of buffers. This
/// one learns; inference::UNet is the same function for who only looks.
class UNet {
 public:
  explicit UNet(const inference::UNetConfig& config);
  UNet(const UNet&) = delete;
  UNet& operator=(const UNet&) = delete;

  /// [N, 3, H, W] float32, BGR in 0..255, H and W multiples of config().multiple() -> logits
  /// [N, kClasses, H * upscale / stem, W * upscale / stem].
  at::Tensor forward(const at::Tensor& image) const;
  /// Whether batches are normalised by their own statistics, which then move the running ones. At first so.
  void train(bool training) { training_ = training; }

  /// Mean and standard deviation of each colour over training images [N, 3, H, W].
  void fit_normaliser(const at::Tensor& images);
  /// He's initialisation, from `random` alone; masks begin nearly empty.
  void initialise(common::RandomStream& random);

  const inference::UNetConfig& config() const { return config_; }
  Parameters& tensors() { return tensors_; }
  const Parameters& tensors() const { return tensors_; }

 private:
  /// A convolution, which needs no bias, as batch normalisation follows.
  struct Unit {
    at::Tensor weight;
    std::int64_t stride, padding;
    BatchNorm norm;
  };

  void add_unit(const std::string& name, std::int64_t in, std::int64_t out, std::int64_t kernel,
                std::int64_t stride, std::int64_t padding);
  at::Tensor run(const Unit& unit, const at::Tensor& x) const;

  inference::UNetConfig config_;
  bool training_ = true;
  Parameters tensors_;
  at::Tensor colour_mean_, colour_std_;  ///< buffers
  std::vector<Unit> units_;              ///< stem, then two a level down, then two a level up
  at::Tensor head_weight_, head_bias_;
};

}  // namespace lodestone::nets
