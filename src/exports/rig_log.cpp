#include "lodestone/exports/rig_log.h"

namespace lodestone::exports {
namespace {

constexpr const char* kDish = "dish";
constexpr const char* kCamera = "camera";
/// Who begins to look in the middle of a log needs to hear of the frame, too.
constexpr std::uint64_t kFrameEvery_ns = 10'000'000'000;

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
}

void RigLog::image(std::uint64_t time_ns, std::uint64_t taken_ns, std::string_view jpeg) {
  writer_.write(images_, time_ns, compressed_image_message(taken_ns, kCamera, jpeg));
}

void RigLog::event(std::uint64_t time_ns, LogLevel level, const std::string& text) {
  writer_.write(events_, time_ns, log_message(time_ns, level, text));
}

}  // namespace lodestone::exports
