#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodestone/exports/log_messages.h"
#include "lodestone/exports/mcap_writer.h"

namespace lodestone::exports {

/// One step as the log has it; what is not known is absent.
struct LoggedStep {
  std::uint64_t time_ns = 0;
  std::optional<geometry::Pose2> sensed, truth, target;
  std::optional<OfCoils> current_A;  ///< as asked
  std::optional<CoilReading> reading;
  StepFacts facts;
};

/// What happens on a rig, as an MCAP file that Foxglove shows as it is (docs/logs.md lists the topics). Poses
/// are in the dish frame. Throws IoError as McapWriter does.
class RigLog {
 public:
  /// `facts`: what is written, and by what, such as its configuration; they are the metadata `lodestone`.
  RigLog(const std::string& path, const std::map<std::string, std::string>& facts);

  /// Also tells what has changed since the step before: the needle is lost or seen again, the coils report
  /// other faults, the rig is no longer what was identified.
  void step(const LoggedStep& step);
  /// `jpeg` as it was taken at `taken_ns`.
  void image(std::uint64_t time_ns, std::uint64_t taken_ns, std::string_view jpeg);
  void event(std::uint64_t time_ns, LogLevel level, const std::string& text);
  /// What was told is in the file, whatever happens to the process.
  void flush() { writer_.flush(); }
  void finish() { writer_.finish(); }

 private:
  std::uint16_t channel(const char* topic, const char* schema);
  void pose(std::uint16_t channel, std::uint64_t time_ns, const std::optional<geometry::Pose2>& pose);
  void tell_changes(const LoggedStep& step);

  McapWriter writer_;
  std::map<std::string, std::uint16_t> schemas_;
  std::uint16_t images_, needle_, truth_, target_, frames_, pulses_, status_, steps_, events_;
  std::optional<std::uint64_t> framed_ns_;  ///< when the frame was told last
  // Of the step before.
  bool sensed_ = true;
  bool rig_changed_ = false;
  std::vector<std::string> faults_;
};

}  // namespace lodestone::exports
