#pragma once

#include <cstdint>
#include <fstream>
#include <opencv2/core/mat.hpp>
#include <string>

namespace lodestone::imaging {

/// Writes frames as an animated GIF (GIF89a) that starts over at its end: what web pages show without a
/// player. A frame holds the pixels that differ visibly from what is shown already, in up to 255 colours of
/// its own.
class GifWriter {
 public:
  /// `size` of the frames, at most 65535 a side. The format counts hundredths of a second: the rate is
  /// rounded to them, to at most 50 Hz. Throws IoError when the file cannot be opened, LogicFault when a
  /// number is out of range.
  GifWriter(const std::string& file, cv::Size size, double frame_rate_hz);

  /// One 8-bit BGR frame. Throws IoError when the disk is full, LogicFault when the frame is of another size
  /// or type, or after finish().
  void write(const cv::Mat& image);
  /// Shows the last frame for so long before it starts over, and closes the file. Throws IoError when it is
  /// not whole.
  void finish(double rest_s = 1.5);

  std::int64_t frames() const { return frames_; }

 private:
  void put_frame(const cv::Mat& image, const cv::Mat& changed, int delay_cs);
  void check() const;

  std::string file_;
  std::ofstream out_;
  cv::Size size_;
  int delay_cs_;
  std::int64_t frames_ = 0;
  cv::Mat shown_;  // what a viewer sees after the frames so far
};

}  // namespace lodestone::imaging
