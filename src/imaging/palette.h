#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace lodestone::imaging {

/// A few colours that stand for all of an image's: median cut (Heckbert 1982) over its colours at five bits a
/// channel, each colour the mean of the pixels it stands for.
class Palette {
 public:
  /// The pixels of `image` (8-bit BGR) where `mask` (8-bit) is not zero; at most `colours` (1 to 256) of
  /// them. Empty when no pixel is in the mask. Throws LogicFault when the images do not fit each other.
  Palette(const cv::Mat& image, const cv::Mat& mask, int colours);

  const std::vector<cv::Vec3b>& colours() const { return colours_; }
  /// Of a colour that was in the image.
  std::uint8_t index_of(const cv::Vec3b& colour) const;

 private:
  std::vector<cv::Vec3b> colours_;
  std::vector<std::uint8_t> index_;  // by five bits a channel
};

}  // namespace lodestone::imaging
