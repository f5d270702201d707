#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/array.h"
#include "lodestone/inference/convolution.h"
#include "lodestone/inference/unet_config.h"

namespace lodestone::inference {

/// A trained U-Net (what it is made of: nets/unet.h) for evaluation only: one image at a time, batch
/// normalisation folded into the convolutions. Threads share it, each with a Workspace of its own.
class UNet {
 public:
  /// Activations of one thread; grows to the largest image seen.
  class Workspace {
    friend class UNet;
    std::vector<FeatureMap> across_;  ///< of each level down
    FeatureMap from_, to_, joined_;
    CacheAligned<float> lines_;
  };

  /// `weights`: the tensors of a nets::UNet by name. Throws CheckpointError that begins with `what`.
  UNet(const UNetConfig& config, const Arrays& weights, const std::string& what);

  /// `image` [height, width, 3] 8-bit BGR, sides multiples of config().multiple() -> `logits`
  /// [UNetConfig::kClasses, height * upscale / stem, width * upscale / stem]. Throws LogicFault on other
  /// sides.
  void forward(const std::uint8_t* image, std::int64_t height, std::int64_t width, float* logits,
               Workspace& workspace) const;

  const UNetConfig& config() const { return config_; }

 private:
  void normalise(const std::uint8_t* image, std::int64_t height, std::int64_t width, FeatureMap& out) const;
  void enlarge(const FeatureMap& head, float* logits) const;

  UNetConfig config_;
  std::array<float, 3> gain_{};  ///< of each colour
  std::array<float, 3> offset_{};
  std::vector<Convolution> units_;  ///< stem, then two a level down, then two a level up, head
};

}  // namespace lodestone::inference
