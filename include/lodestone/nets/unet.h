#pragma once

#include <cstdint>
#include <vector>

#include <torch/torch.h>

#include "lodestone/common/random.h"

namespace lodestone::nets {

/// Shape of the segmentation network.
struct UNetConfig {
  std::int64_t width = 16;   ///< channels at the finest level; each level below has twice as many
  std::int64_t depth = 3;    ///< levels below the finest
  std::int64_t stem = 4;     ///< the first layer shrinks the image by this
  std::int64_t upscale = 2;  ///< the last layer enlarges the mask by this

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("width", width, "channels", "channels at the finest level; every level below has twice as many",
            {2, 256});
    v.field("depth", depth, "levels", "levels below the finest", {1, 6});
    v.field("stem", stem, "", "the first layer shrinks the image by this factor", {1, 16});
    v.field("upscale", upscale, "", "the last layer enlarges the mask by this factor", {1, 16});
  }
  /// Sides of an image must be multiples of this.
  std::int64_t multiple() const { return stem << depth; }
};

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
