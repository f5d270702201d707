#pragma once

#include <cstdint>
#include <vector>

#include <torch/nn/modules/batchnorm.h>
#include <torch/nn/modules/conv.h>

#include "lodestone/common/random.h"
#include "lodestone/nets/unet_config.h"

namespace lodestone::nets {

/// U-Net (Ronneberger, Fischer, Brox, 2015) with a strided first layer and a sub-pixel last one (Shi et al.,
/// 2016), because the needle is thin and the crop has to be segmented in a few milliseconds. Every level is
/// two 3x3 convolutions with batch normalisation and ReLU. The colour normaliser is a pair of buffers.
class UNetImpl : public torch::nn::Module {
 public:
  /// `batch_norm` false: the network has none, as after folded().
  explicit UNetImpl(const UNetConfig& config, std::int64_t classes = 2, bool batch_norm = true);

  /// [N, 3, H, W] float32, BGR in 0..255, H and W multiples of config().multiple() -> logits
  /// [N, classes, H * upscale / stem, W * upscale / stem].
  torch::Tensor forward(const torch::Tensor& image);
  /// The same from (image - colour_mean) / colour_std.
  torch::Tensor forward_normalised(torch::Tensor x);

  /// Mean and standard deviation of each colour over training images [N, 3, H, W].
  void fit_normaliser(const torch::Tensor& images);
  /// He's initialisation, from `random` alone; masks begin nearly empty.
  void initialise(common::RandomStream& random);

  const UNetConfig& config() const { return config_; }
  std::int64_t classes() const { return classes_; }

  torch::Tensor colour_mean, colour_std;  ///< buffers [1, 3, 1, 1]

 private:
  friend class UNetFolder;
  struct Unit {
    torch::nn::Conv2d convolution{nullptr};
    torch::nn::BatchNorm2d norm{nullptr};
    std::int64_t stride = 1;
    std::int64_t padding = 0;
  };
  Unit make_unit(const std::string& name, std::int64_t in, std::int64_t out, std::int64_t kernel,
                 std::int64_t stride, std::int64_t padding);
  torch::Tensor convolve(torch::nn::Conv2d& convolution, std::int64_t stride, std::int64_t padding,
                         const torch::Tensor& x) const;
  torch::Tensor run(Unit& unit, const torch::Tensor& x);

  UNetConfig config_;
  std::int64_t classes_;
  bool batch_norm_;
  std::vector<Unit> units_;  ///< stem, then two a level down, then two a level up
  torch::nn::Conv2d head_{nullptr};
};
TORCH_MODULE(UNet);

/// The same function in evaluation mode, with every batch normalisation folded into its convolution.
UNet folded(UNet& network);

}  // namespace lodestone::nets
