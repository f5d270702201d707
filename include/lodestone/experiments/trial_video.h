#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lodestone/control/control_loop.h"
#include "lodestone/experiments/trial.h"
#include "lodestone/imaging/annotate.h"
#include "lodestone/imaging/frame.h"
#include "lodestone/imaging/gif_writer.h"
#include "lodestone/imaging/video_writer.h"

namespace lodestone::experiments {

/// Which trials are filmed.
struct RecordingConfig {
  bool enabled = false;
  std::int64_t trials = 1;
  double speed = 3.0;
  double scale = 0.6;
  bool gif = false;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("enabled", enabled, "", "film trials; needs the camera as sensor");
    v.field("trials", trials, "", "so many of every task, rig and controller", {0, 100000});
    v.field("speed", speed, "", "how much faster than in reality the video runs", {0.1, 100.0});
    v.field("scale", scale, "", "size of the video, of the camera's image", {0.05, 1.0});
    v.field("gif", gif, "",
            "also as an animated GIF beside the video, which web pages show without a player");
  }
};

/// Films one trial: every image the controller acted on, with dish, estimated pose, target, reference path or
/// the way through stitches, the headings that they want, path so far and currents drawn in. Beside the video
/// lies its last image as a JPEG, and the GIF.
class TrialVideo {
 public:
  /// `file` without ending. Throws IoError.
  TrialVideo(const std::string& file, const RecordingConfig& config, double period_s,
             const imaging::BenchGeometry& bench, double max_current_A, const TrialPlan& plan);
  /// Closes the video; it stays playable after a fault.
  ~TrialVideo();

  /// One observation. `camera` as calibrated. Throws IoError when the disk is full.
  void show(const imaging::Frame& frame, const imaging::CameraModel& camera, const control::StepRecord& step);
  /// Throws IoError when the video is not whole.
  void finish();

 private:
  void open(cv::Size size);

  std::string file_;
  RecordingConfig config_;
  double period_s_;
  imaging::Annotation annotation_;
  std::unique_ptr<imaging::VideoWriter> writer_;  ///< opened at the first image, when its size is known
  std::unique_ptr<imaging::GifWriter> gif_;       ///< likewise
  cv::Mat last_;                                  ///< at the size of the video
};

}  // namespace lodestone::experiments
