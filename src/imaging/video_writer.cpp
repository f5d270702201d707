#include "lodestone/imaging/video_writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "lodestone/common/error.h"

namespace lodestone::imaging {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFramesBetweenSpaceChecks = 16;
constexpr std::uintmax_t kLeastSpace_bytes = 8U << 20U;  // more than the frames between two checks

/// Sides even and at least 2.
cv::Size scaled_size(cv::Size size, double scale) {
  const auto even = [scale](int side) {
    return std::max(2, static_cast<int>(std::floor(side * scale + 1e-9)) / 2 * 2);
  };
  return {even(size.width), even(size.height)};
}

}  // namespace

VideoWriter::VideoWriter(const std::string& file, cv::Size size, double frame_rate_hz, double scale)
    : file_(file),
      frame_size_(size),
      size_(scaled_size(size, scale)),
      frame_rate_hz_(frame_rate_hz),
      writer_(std::make_unique<cv::VideoWriter>()) {
  LODESTONE_CHECK(size.width >= 2 && size.height >= 2, "frames must be at least 2x2 pixels");
  LODESTONE_CHECK(frame_rate_hz > 0.0, "frame rate " + std::to_string(frame_rate_hz) + " must be positive");
  LODESTONE_CHECK(scale > 0.0 && scale <= 1.0, "scale " + std::to_string(scale) + " must lie in (0, 1]");
  const std::string ending = fs::path(file_).extension().string();
  if (ending != ".mp4" && ending != ".avi")
    throw common::IoError("cannot write the video " + file_ + ": its name must end in .mp4 or .avi");
  const fs::path folder = fs::path(file_).parent_path();
  if (!folder.empty() && !fs::is_directory(folder))
    throw common::IoError("cannot write the video " + file_ + ": there is no folder " + folder.string());

  codec_ = "H.264";
  if (ending == ".mp4" && open(cv::CAP_FFMPEG, "avc1")) return;
  codec_ = "Motion JPEG";
  file_ = fs::path(file_).replace_extension(".avi").string();
  if (!open(cv::CAP_OPENCV_MJPEG, "MJPG"))
    throw common::IoError("cannot write the video " + file_ + "; is the folder writable?");
}

VideoWriter::~VideoWriter() = default;

bool VideoWriter::open(int backend, const char* fourcc) {
  const int code = cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]);
  return writer_->open(file_, backend, code, frame_rate_hz_, size_) && writer_->isOpened();
}

void VideoWriter::write(const cv::Mat& image) {
  LODESTONE_CHECK(writer_ != nullptr, "the video " + file_ + " is finished");
  LODESTONE_CHECK(image.type() == CV_8UC3 && image.size() == frame_size_,
                  "a frame of the video must be 8-bit BGR of " + std::to_string(frame_size_.width) + "x" +
                      std::to_string(frame_size_.height) + ", not " + std::to_string(image.cols) + "x" +
                      std::to_string(image.rows));
  if (frames_ % kFramesBetweenSpaceChecks == 0) check_space();
  try {
    if (size_ == frame_size_) {
      writer_->write(image);
    } else {
      cv::resize(image, scaled_, size_, 0.0, 0.0, cv::INTER_AREA);
      writer_->write(scaled_);
    }
  } catch (const cv::Exception&) {
    throw common::IoError("cannot write frame " + std::to_string(frames_) + " of the video " + file_ +
                          ": is the disk full?");
  }
  ++frames_;
}

/// OpenCV's writers do not tell when the disk is full: better to stop before.
void VideoWriter::check_space() const {
  std::error_code failed;
  const fs::space_info space = fs::space(file_, failed);
  if (!failed && space.available < kLeastSpace_bytes) {
    throw common::IoError("cannot go on with the video " + file_ + ": " +
                          std::to_string(space.available >> 20U) + " MiB are free, must be at least " +
                          std::to_string(kLeastSpace_bytes >> 20U) + " MiB; free some space");
  }
}

void VideoWriter::finish() {
  LODESTONE_CHECK(writer_ != nullptr, "the video " + file_ + " is finished");
  writer_.reset();
  if (frames_ == 0) return;
  cv::VideoCapture reader(file_, cv::CAP_FFMPEG);
  // The index comes last in the file: a number that agrees says that all of it was written.
  const double found = reader.isOpened() ? reader.get(cv::CAP_PROP_FRAME_COUNT) : 0.0;
  if (std::llround(found) != frames_)
    throw common::IoError("the video " + file_ + " holds " + std::to_string(std::llround(found)) + " of " +
                          std::to_string(frames_) + " frames: is the disk full?");
}

}  // namespace lodestone::imaging
