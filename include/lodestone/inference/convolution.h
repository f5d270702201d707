#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/inference/array.h"
#include "lodestone/inference/gemm.h"

namespace lodestone::inference {

/// What a layer makes of an image: [height, width, channels], row-major. Grows to the largest image seen, and
/// what it held is lost then.
class FeatureMap {
 public:
  /// Room for an image, which holds anything until it is filled.
  float* resize(std::int64_t height, std::int64_t width, std::int64_t channels);

  std::int64_t height() const { return height_; }
  std::int64_t width() const { return width_; }
  std::int64_t channels() const { return channels_; }
  /// The pixels of a row, one after the other.
  const float* row(std::int64_t y) const { return values_.data() + y * width_ * channels_; }

 private:
  std::int64_t height_ = 0, width_ = 0, channels_ = 0;
  CacheAligned<float> values_;
};

/// How the square kernel of a convolution moves over an image with a border of zeros.
struct Stride {
  std::int64_t step = 1;    ///< pixels from one place to the next, both ways
  std::int64_t border = 0;  ///< pixels
};

/// A convolution with a bias, and a ReLU where one follows, for evaluation only. Weights are packed once and
/// read from then on, so threads share it. A row of the result is one product of matrices (gemm.h), and so
/// bitwise the same on every processor with AVX2 or AVX-512: lines of the image that lie under the kernel
/// together are interleaved, so that what it covers at a place is contiguous, and overlaps with the next.
class Convolution {
 public:
  /// `weight` [outputs, channels, side, side], `bias` [outputs].
  Convolution(const std::vector<float>& weight, std::vector<float> bias, std::int64_t side, Stride stride,
              bool relu);

  /// `out` is another map than `in`, which has as many channels as the weight; `lines` is scratch.
  void run(const FeatureMap& in, FeatureMap& out, CacheAligned<float>& lines) const;

 private:
  void interleave(const FeatureMap& in, std::int64_t first, float* lines) const;

  std::int64_t side_, channels_;
  Stride stride_;
  bool relu_;
  std::vector<float> bias_;
  PackedMatrix<float> weight_;  ///< [column, line and channel under the kernel, outputs]
};

/// Largest of each square of two by two pixels; sides must be even.
void halve(const FeatureMap& in, FeatureMap& out);
/// The channels of `across`, then those of `in` with each pixel as a square of two by two.
void double_beside(const FeatureMap& across, const FeatureMap& in, FeatureMap& out);

}  // namespace lodestone::inference
