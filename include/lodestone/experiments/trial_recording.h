#pragma once

#include <optional>
#include <string>

#include "lodestone/experiments/step_log.h"
#include "lodestone/experiments/trial_video.h"

namespace lodestone::experiments {

/// Where films and logs of trials go; the folders exist, and without a name there are none.
struct TrialFolders {
  std::string videos, logs;
  McapConfig mcap;
};

/// What is recorded of one trial while it is driven, besides its samples: its film and its log.
class TrialRecording {
 public:
  /// What is recorded. All must outlive the recording.
  struct Subject {
    std::string name;  ///< of the files, without ending
    const TrialPlan& plan;
    StepLog::Sources sources;
    const physics::RigDescription& rig;
    double period_s, max_current_A;
    bool repeatable;  ///< driven again it is the same, and takes the place of what there is of it
  };
  /// Throws IoError.
  TrialRecording(const TrialFolders& folders, const RecordingConfig& films, const Subject& subject);

  /// A trial's watch. Throws IoError.
  void show(const TrialSample& sample);
  /// Throws IoError where film or log are not whole.
  void finish(const TrialResult& result);

 private:
  TrialPlan plan_;
  const session::CameraDetector* camera_;
  std::optional<TrialVideo> video_;
  std::optional<StepLog> log_;
};

}  // namespace lodestone::experiments
