#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/imaging/frame.h"

namespace lodestone::imaging {

/// What a usable image of one camera looks like.
struct FrameGuardConfig {
  std::int64_t width_px = 1280;
  std::int64_t height_px = 1024;
  std::int64_t white_level = 250;    // D: clipped, with room for noise and JPEG
  double max_white_fraction = 0.25;  // D: the ring light's glare stays far below
  std::int64_t sample_step_px = 16;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("width_px", width_px, "px", "expected width of the images", {1, 65536});
    v.field("height_px", height_px, "px", "expected height of the images", {1, 65536});
    v.field("white_level", white_level, "grey levels",
            "a pixel is clipped when all its channels are at least this", {1, 255});
    v.retired("max_white_share", "max_white_fraction");
    v.field("max_white_fraction", max_white_fraction, "", "largest fraction of clipped pixels", {0.0, 1.0});
    v.field("sample_step_px", sample_step_px, "px", "distance of the pixels looked at for overexposure",
            {1, 256});
  }
};

/// Looks at every image of one camera before anything is read from it. Give each camera its own guard.
class FrameGuard {
 public:
  /// `camera` names it in messages.
  FrameGuard(const FrameGuardConfig& config, std::string camera);

  /// Throws common::HardwareError when the frame is empty, not 8-bit BGR, of another size, overexposed, or
  /// frozen (the very bytes of the frame before, or a stamp that is not newer). A real sensor's noise makes
  /// two equal images impossible. A frame that was refused is not remembered. The guard shares the last
  /// image, because copying it would cost as much as straightening it: draw into a copy.
  void check(const Frame& frame);

  /// Forgets the last frame, for example after the camera was opened anew.
  void reset();

 private:
  void check_format(const cv::Mat& image) const;
  void check_exposure(const cv::Mat& image) const;
  void check_progress(const Frame& frame) const;

  FrameGuardConfig config_;
  std::string camera_;
  cv::Mat last_;
  double last_stamp_s_ = 0.0;
};

}  // namespace lodestone::imaging
