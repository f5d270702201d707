#include "lodestone/experiments/trial_recording.h"

#include "lodestone/common/config.h"
#include "lodestone/rig/rendered_camera.h"

namespace lodestone::experiments {
namespace {

std::map<std::string, std::string> facts_of(const TrialRecording::Subject& subject) {
  return {{"trial", subject.name},
          {"rig", common::config_to_json<physics::RigDescription>(subject.rig).dump()}};
}

}  // namespace

TrialRecording::TrialRecording(const TrialFolders& folders, const RecordingConfig& films,
                               const Subject& subject)
    : plan_(subject.plan), camera_(subject.sources.camera) {
  if (!folders.videos.empty() && camera_ != nullptr && plan_.index < films.trials)
    video_.emplace(folders.videos + "/" + subject.name, films, subject.period_s, rig::bench_of(subject.rig),
                   subject.max_current_A, plan_);
  if (folders.logs.empty()) return;
  const std::string file = folders.logs + "/" + subject.name;
  log_.emplace(subject.repeatable ? file + ".mcap" : fresh_log(file), folders.mcap, facts_of(subject),
               subject.sources);
  log_->event(exports::LogLevel::kInfo, "trial " + subject.name);
}

void TrialRecording::show(const TrialSample& sample) {
  if (log_) {
    const geometry::Vector2& target_m = sample.step.target_m;
    log_->step(sample.step,
               {geometry::Pose2{target_m.x(), target_m.y(), sample.step.target_heading_rad.value_or(0.0)},
                sample.true_pose});
  }
  if (video_ && camera_->calibration())
    video_->show(camera_->frame(), camera_->calibration()->camera, sample.step);
}

void TrialRecording::finish(const TrialResult& result) {
  if (log_) {
    log_->event(result.completed ? exports::LogLevel::kInfo : exports::LogLevel::kError,
                result.completed ? "the trial has ended" : "stopped: " + result.stop_reason);
    log_->finish();
  }
  if (video_) video_->finish();
}

}  // namespace lodestone::experiments
