#pragma once

#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

namespace lodestone::tests {

/// What another program sees of a film or an animation, frame by frame.
inline std::vector<cv::Mat> read_film(const std::string& file) {
  cv::VideoCapture reader(file, cv::CAP_FFMPEG);
  std::vector<cv::Mat> images;
  for (cv::Mat image; reader.read(image);) images.push_back(image.clone());
  return images;
}

}  // namespace lodestone::tests
