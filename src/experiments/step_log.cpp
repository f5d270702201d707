#include "lodestone/experiments/step_log.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/imaging/image_file.h"

namespace lodestone::experiments {
namespace {

using exports::LogLevel;

std::map<std::string, std::string> with_program(std::map<std::string, std::string> facts) {
  facts["program"] = "lodestone " + common::build_and_host_facts().value("version", std::string());
  return facts;
}

LogQueue::Writes writes(const common::Clock& clock) {
  return clock.passes_by_itself() ? LogQueue::Writes::kInBackground : LogQueue::Writes::kAtOnce;
}

exports::StepFacts facts_of(const control::StepRecord& record, const std::optional<geometry::Pose2>& target) {
  exports::StepFacts facts;
  const control::PoseEstimate& estimate = record.estimate;
  facts.sensed = estimate.valid;
  facts.reason = estimate.reason;
  if (estimate.valid) {
    facts.position_sigma_m = estimate.position_sigma_m;
    facts.heading_sigma_rad = estimate.heading_sigma_rad;
    if (target) facts.error_m = (estimate.pose.position_m() - target->position_m()).norm();
  }
  if (!record.last) facts.action.assign(record.action.begin(), record.action.end());
  if (record.drive_gain) {
    facts.log_drive_gain = record.drive_gain->log_mean;
    facts.log_drive_gain_sigma = record.drive_gain->log_sigma;
  }
  facts.rig_changed = record.rig_changed;
  return facts;
}

bool has_pulse(const control::StepRecord& record) {
  return !record.last && (record.estimate.valid || record.either_way || record.probe);
}

}  // namespace

std::vector<std::string> free_mcap_keys() { return {"mcap.enabled", "mcap.images", "mcap.jpeg_quality"}; }

std::string fresh_log(const std::string& file) {
  std::string path = file + ".mcap";
  for (int start = 2; std::filesystem::exists(path); ++start)
    path = file + "-" + std::to_string(start) + ".mcap";
  return path;
}

StepLog::StepLog(const std::string& path, const McapConfig& config,
                 const std::map<std::string, std::string>& facts, const Sources& sources)
    : sources_(sources),
      config_(config),
      offset_s_(sources.clock.passes_by_itself() ? common::unix_time_s() - sources.clock.now_s() : 0.0),
      queue_(path, with_program(facts), writes(sources.clock)) {}

std::uint64_t StepLog::time_ns(double rig_s) const {
  return static_cast<std::uint64_t>(std::llround(1e9 * std::max(0.0, offset_s_ + rig_s)));
}

void StepLog::step(const control::StepRecord& record, const Beside& beside) {
  const std::optional<rig::CoilStatus>& reported = sources_.coils.reported();
  exports::LoggedStep step;
  step.time_ns = time_ns(sources_.clock.now_s());
  if (record.estimate.valid) step.sensed = record.estimate.pose;
  step.truth = beside.truth;
  step.target = beside.target;
  if (has_pulse(record)) step.current_A = record.current_A.list();
  if (reported) {
    step.reading.emplace();
    step.reading->current_A = reported->current_A.list();
    step.reading->temperature_C = reported->temperature_C.list();
    step.reading->supply_V = reported->supply_V;
    step.reading->faults = reported->faults;
  }
  step.facts = facts_of(record, beside.target);
  if (config_.images && sources_.camera != nullptr) image();
  queue_.tell([step = std::move(step)](exports::RigLog& log) { log.step(step); });
}

void StepLog::image() {
  const imaging::Frame& frame = sources_.camera->frame();
  if (frame.image.empty() || image_s_ == frame.stamp_s) return;
  image_s_ = frame.stamp_s;
  if (queue_.behind()) {
    ++left_out_;
    return;
  }
  if (left_out_ > 0)
    event(LogLevel::kWarning, std::to_string(std::exchange(left_out_, 0)) +
                                  " images are left out: they came faster than they could be written");
  // The camera's next image is another one; nobody draws on this.
  queue_.tell([image = frame.image, time = time_ns(sources_.clock.now_s()), taken = time_ns(frame.stamp_s),
               quality = static_cast<int>(config_.jpeg_quality)](exports::RigLog& log) {
    log.image(time, taken, imaging::encoded_image(image, ".jpg", quality));
  });
}

void StepLog::event(LogLevel level, const std::string& text) {
  queue_.tell([level, text, time = time_ns(sources_.clock.now_s())](exports::RigLog& log) {
    log.event(time, level, text);
  });
}

void StepLog::flush() {
  queue_.tell([](exports::RigLog& log) { log.flush(); });
}

void StepLog::finish() { queue_.finish(); }

}  // namespace lodestone::experiments
