#include "lodestone/experiments/trial_video.h"

#include <opencv2/imgproc.hpp>

#include "lodestone/common/files.h"
#include "lodestone/imaging/image_file.h"

namespace lodestone::experiments {
namespace {

constexpr double kHeadingsApart_m = 0.005;  // that are drawn along a path

}  // namespace

TrialVideo::TrialVideo(const std::string& file, const RecordingConfig& config, double period_s,
                       const imaging::BenchGeometry& bench, double max_current_A, const TrialPlan& plan)
    : file_(file), config_(config), period_s_(period_s) {
  annotation_.bench = bench;
  annotation_.max_current_A = max_current_A;
  annotation_.task = plan.task;
  annotation_.target_m = plan.target_m;
  if (plan.path) annotation_.reference_m = plan.path->points_m();
  if (plan.path) annotation_.reference_headings = plan.path->poses(kHeadingsApart_m);
  if (!plan.stitches.empty())
    annotation_.reference_m =
        geometry::way_through_all(plan.stitches, plan.suture.approach_m, plan.suture.leave_m).points_m();
  for (const geometry::Stitch& stitch : plan.stitches)
    annotation_.reference_headings.insert(annotation_.reference_headings.end(), {stitch.entry, stitch.exit});
}

TrialVideo::~TrialVideo() = default;

void TrialVideo::show(const imaging::Frame& frame, const imaging::CameraModel& camera,
                      const control::StepRecord& step) {
  if (!writer_) open(frame.image.size());
  annotation_.pose.reset();
  annotation_.error_m.reset();
  annotation_.no_pose_reason = step.estimate.reason;
  // A point stays the target, wherever the needle is led over on its way.
  if (!annotation_.reference_m.empty()) annotation_.target_m = step.target_m;
  annotation_.target_heading_rad = step.target_heading_rad;
  annotation_.time_s = step.time_s;
  annotation_.coil_current_A = step.current_A.list();
  if (!step.estimate.valid) {
    if (annotation_.travelled_m.empty() || !annotation_.travelled_m.back().empty())
      annotation_.travelled_m.emplace_back();
  } else {
    annotation_.pose = step.estimate.pose;
    annotation_.position_sigma_m = step.estimate.position_sigma_m;
    annotation_.last_seen_m = step.estimate.pose.position_m();
    if (annotation_.travelled_m.empty()) annotation_.travelled_m.emplace_back();
    annotation_.travelled_m.back().push_back(step.estimate.pose.position_m());
    annotation_.error_m = (step.estimate.pose.position_m() - *annotation_.target_m).norm();
  }
  cv::Mat image = frame.image.clone();
  imaging::annotate(image, camera, annotation_);
  writer_->write(image);
  cv::resize(image, last_, writer_->size(), 0.0, 0.0, cv::INTER_AREA);
  if (gif_) gif_->write(last_);
}

void TrialVideo::open(cv::Size size) {
  const double rate_hz = config_.speed / period_s_;
  writer_ = std::make_unique<imaging::VideoWriter>(file_ + ".mp4", size, rate_hz, config_.scale);
  if (config_.gif) gif_ = std::make_unique<imaging::GifWriter>(file_ + ".gif", writer_->size(), rate_hz);
}

void TrialVideo::finish() {
  if (!writer_) return;
  writer_->finish();
  if (gif_) gif_->finish();
  imaging::write_image(file_ + ".jpg", last_);
}

}  // namespace lodestone::experiments
