#include "lodestone/exports/rig_log.h"

#include <utility>

namespace lodestone::exports {
namespace {

constexpr const char* kDish = "dish";
constexpr const char* kCamera = "camera";
/// Who begins to look in the middle of a log needs to hear of the frame, too.
constexpr std::uint64_t kFrameEvery_ns = 10'000'000'000;

std::string listed(const std::vector<std::string>& faults) {
  std::string text;
  for (const std::string& fault : faults) text += (text.empty() ? "" : ", ") + fault;
  return text;
}

}  // namespace

RigLog::RigLog(const std::string& path, const std::map<std::string, std::string>& facts)
    : writer_(path),
      images_(channel("/camera/image", "foxglove.CompressedImage")),
      needle_(channel("/needle/pose", "foxglove.PoseInFrame")),
      truth_(channel("/needle/truth", "foxglove.PoseInFrame")),
      target_(channel("/target", "foxglove.PoseInFrame")),
      frames_(channel("/tf", "foxglove.FrameTransform")),
      pulses_(channel("/coils/pulse", "lodestone.CoilPulse")),
      status_(channel("/coils/status", "lodestone.CoilStatus")),
      steps_(channel("/step", "lodestone.Step")),
      events_(channel("/log", "foxglove.Log")) {
  writer_.add_metadata("lodestone", facts);
}

std::uint16_t RigLog::channel(const char* topic, const char* schema) {
  const auto found = schemas_.find(schema);
  const std::uint16_t id = found != schemas_.end()
                               ? found->second
                               : writer_.add_schema(schema, "protobuf", file_descriptor_set(schema));
  schemas_[schema] = id;
  return writer_.add_channel(topic, id, "protobuf");
}

void RigLog::pose(std::uint16_t channel, std::uint64_t time_ns, const std::optional<geometry::Pose2>& pose) {
  if (pose) writer_.write(channel, time_ns, pose_in_frame_message(time_ns, kDish, *pose));
}

void RigLog::step(const LoggedStep& step) {
  const std::uint64_t time_ns = step.time_ns;
  if (!framed_ns_ || time_ns >= *framed_ns_ + kFrameEvery_ns) {
    writer_.write(frames_, time_ns, frame_transform_message(time_ns, "world", kDish, {}));
    framed_ns_ = time_ns;
  }
  pose(needle_, time_ns, step.sensed);
  pose(truth_, time_ns, step.truth);
  pose(target_, time_ns, step.target);
  if (step.current_A) writer_.write(pulses_, time_ns, coil_pulse_message(time_ns, *step.current_A));
  if (step.reading) writer_.write(status_, time_ns, coil_status_message(time_ns, *step.reading));
  writer_.write(steps_, time_ns, step_message(time_ns, step.facts));
  tell_changes(step);
}

void RigLog::tell_changes(const LoggedStep& step) {
  const StepFacts& facts = step.facts;
  if (std::exchange(sensed_, facts.sensed) != facts.sensed)
    event(step.time_ns, facts.sensed ? LogLevel::kInfo : LogLevel::kWarning,
          facts.sensed ? "the needle is seen again" : "no pose: " + facts.reason);
  if (!std::exchange(rig_changed_, facts.rig_changed) && facts.rig_changed)
    event(step.time_ns, LogLevel::kWarning,
          "the needle no longer moves as the simulator expects of any strength of the rig");
  const std::vector<std::string> faults = step.reading ? step.reading->faults : faults_;
  if (std::exchange(faults_, faults) != faults)
    event(step.time_ns, faults.empty() ? LogLevel::kInfo : LogLevel::kError,
          faults.empty() ? "the coils report no fault any more" : "the coils report: " + listed(faults));
}

void RigLog::image(std::uint64_t time_ns, std::uint64_t taken_ns, std::string_view jpeg) {
  writer_.write(images_, time_ns, compressed_image_message(taken_ns, kCamera, jpeg));
}

void RigLog::event(std::uint64_t time_ns, LogLevel level, const std::string& text) {
  writer_.write(events_, time_ns, log_message(time_ns, level, text));
}

}  // namespace lodestone::exports
