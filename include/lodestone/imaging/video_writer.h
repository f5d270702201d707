#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace cv {
class VideoWriter;
}

namespace lodestone::imaging {

/// Writes frames as a video: H.264 into `.mp4` where OpenCV's FFmpeg can encode it, Motion JPEG into `.avi`
/// otherwise or when asked for by that ending.
class VideoWriter {
 public:
  /// `size`: of the frames that come in. `scale`: of the video, at most 1; its sides are rounded down to even
  /// numbers, as H.264 needs. Throws IoError when the ending is another or the file cannot be opened,
  /// LogicFault when a number is out of range.
  VideoWriter(const std::string& file, cv::Size size, double frame_rate_hz, double scale = 1.0);
  /// Closes the file when finish() was not called, without looking whether it is whole.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// One 8-bit BGR frame of the size given. Throws IoError when the disk is full, LogicFault when the frame
  /// is of another size or type, or after finish().
  void write(const cv::Mat& image);

  /// Closes the file and checks that it holds every frame written. Throws IoError when it does not.
  void finish();

  /// "H.264" or "Motion JPEG".
  const std::string& codec() const { return codec_; }
  /// Where the video is: the name asked for, with `.avi` instead of `.mp4` where H.264 cannot be encoded.
  const std::string& file() const { return file_; }
  /// Size of the video.
  cv::Size size() const { return size_; }
  std::int64_t frames() const { return frames_; }

 private:
  bool open(int backend, const char* fourcc);
  void check_space() const;

  std::string file_;
  std::string codec_;
  cv::Size frame_size_;
  cv::Size size_;
  double frame_rate_hz_;
  std::int64_t frames_ = 0;
  std::unique_ptr<cv::VideoWriter> writer_;
  cv::Mat scaled_;
};

}  // namespace lodestone::imaging
