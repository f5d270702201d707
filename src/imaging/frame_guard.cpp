#include "lodestone/imaging/frame_guard.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "lodestone/common/error.h"

namespace lodestone::imaging {
namespace {

/// Row by row, so that an image that is part of a larger one is compared too; a live image differs in its
/// first row, which makes this free.
bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  const std::size_t row_bytes = static_cast<std::size_t>(a.cols) * a.elemSize();
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), row_bytes) != 0) return false;
  }
  return true;
}

}  // namespace

FrameGuard::FrameGuard(const FrameGuardConfig& config, std::string camera)
    : config_(config), camera_(std::move(camera)) {}

void FrameGuard::check(const Frame& frame) {
  check_format(frame.image);
  check_progress(frame);
  check_exposure(frame.image);
  last_ = frame.image;
  last_stamp_s_ = frame.stamp_s;
}

void FrameGuard::reset() { last_.release(); }

void FrameGuard::check_format(const cv::Mat& image) const {
  if (image.empty()) {
    throw common::HardwareError(camera_ + ": empty image (0 pixels), expected " +
                                std::to_string(config_.width_px) + "x" + std::to_string(config_.height_px) +
                                "; check its cable and power");
  }
  if (image.channels() != 3) {
    throw common::HardwareError(camera_ + ": image of " + std::to_string(image.channels()) +
                                " channel(s), must be 3 (blue, green, red); the tape's colour tells the "
                                "needle's head: set a colour pixel format");
  }
  if (image.depth() != CV_8U) {
    throw common::HardwareError(camera_ + ": image of " + std::to_string(8 * image.elemSize1()) +
                                " bits per channel or not of whole numbers, must be 8 bits; set an 8-bit "
                                "pixel format");
  }
  if (image.cols != config_.width_px || image.rows != config_.height_px) {
    throw common::HardwareError(fmt::format(
        "{}: image of {}x{} pixels, must be {}x{}; set the camera's size, or calibrate anew at this one",
        camera_, image.cols, image.rows, config_.width_px, config_.height_px));
  }
}

void FrameGuard::check_exposure(const cv::Mat& image) const {
  const auto step = static_cast<int>(std::max<std::int64_t>(1, config_.sample_step_px));
  std::int64_t seen = 0;
  std::int64_t white = 0;
  for (int row = 0; row < image.rows; row += step) {
    const cv::Vec3b* const pixels = image.ptr<cv::Vec3b>(row);
    for (int column = 0; column < image.cols; column += step) {
      const cv::Vec3b& pixel = pixels[column];
      white += std::min({pixel[0], pixel[1], pixel[2]}) >= config_.white_level ? 1 : 0;
      ++seen;
    }
  }
  const double fraction = static_cast<double>(white) / static_cast<double>(seen);
  if (fraction > config_.max_white_fraction) {
    throw common::HardwareError(
        fmt::format("{}: overexposed image, {:.1f} % of it is white, must be at most {:.1f} %; shorten the "
                    "exposure or dim the light",
                    camera_, 100.0 * fraction, 100.0 * config_.max_white_fraction));
  }
}

void FrameGuard::check_progress(const Frame& frame) const {
  if (!std::isfinite(frame.stamp_s)) {
    throw common::HardwareError(
        fmt::format("{}: image with stamp {:.4g} s, must be a finite time; check the camera's driver",
                    camera_, frame.stamp_s));
  }
  if (last_.empty()) return;
  if (!(frame.stamp_s > last_stamp_s_)) {
    throw common::HardwareError(
        fmt::format("{}: frozen, image with stamp {:.6f} s, must be later than the one before, {:.6f} s; "
                    "restart the camera",
                    camera_, frame.stamp_s, last_stamp_s_));
  }
  if (same_bytes(frame.image, last_)) {
    throw common::HardwareError(
        fmt::format("{}: frozen, the same image twice (stamps {:.6f} s and {:.6f} s); restart the camera",
                    camera_, last_stamp_s_, frame.stamp_s));
  }
}

}  // namespace lodestone::imaging
