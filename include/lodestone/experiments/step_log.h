#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/control/control_loop.h"
#include "lodestone/experiments/log_queue.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/camera_detector.h"

namespace lodestone::experiments {

/// Logs that other programs open (MCAP; docs/logs.md).
struct McapConfig {
  bool enabled = false;
  bool images = true;
  std::int64_t jpeg_quality = 80;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("enabled", enabled, "",
            "log images, poses, currents, temperatures and events as MCAP files, which Foxglove opens");
    v.field("images", images, "",
            "the images that poses were read from are in them, where there is a camera");
    v.field("jpeg_quality", jpeg_quality, "", "of these images", {1, 100});
  }
};

/// What differs between a run and its resumption without changing its results.
std::vector<std::string> free_mcap_keys();

/// A log that does not have the name of one that is there: FILE.mcap, FILE-2.mcap and so on.
std::string fresh_log(const std::string& file);

/// Everything that one rig does, step by step, as an MCAP file (exports::RigLog). Times are the wall clock's
/// (UNIX) on a rig whose time passes by itself, where the log is written in the background; the rig's own on
/// a simulated one, where the same run writes the same bytes. Used by the thread that drives.
class StepLog {
 public:
  /// All must outlive the log; `camera` is null where there are no images.
  struct Sources {
    const common::Clock& clock;
    const safety::Supervisor& coils;
    const session::CameraDetector* camera;
  };
  /// What a step is meant to do, and what only scoring sees.
  struct Beside {
    std::optional<geometry::Pose2> target, truth;
  };

  /// `facts` are the file's metadata, besides the program's version. Throws IoError.
  StepLog(const std::string& path, const McapConfig& config, const std::map<std::string, std::string>& facts,
          const Sources& sources);

  /// A step, as the control loop's observer sees it. Throws IoError with what an earlier one has failed by,
  /// as all that follow do.
  void step(const control::StepRecord& record, const Beside& beside);
  void event(exports::LogLevel level, const std::string& text);
  /// What was told is on its way into the file, whatever happens to the process.
  void flush();
  /// Ends the file; a log that goes without this is ended, too, in silence.
  void finish();

 private:
  std::uint64_t time_ns(double rig_s) const;
  void image();

  Sources sources_;
  McapConfig config_;
  double offset_s_;  ///< from the rig's clock to the log's
  LogQueue queue_;
  std::optional<double> image_s_;  ///< when the last one was taken
  std::int64_t left_out_ = 0;      ///< images
};

}  // namespace lodestone::experiments
