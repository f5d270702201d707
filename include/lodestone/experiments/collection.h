#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "lodestone/control/control_loop.h"
#include "lodestone/control/explorer.h"
#include "lodestone/data/dataset.h"
#include "lodestone/experiments/step_log.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/rig_session.h"

namespace lodestone::experiments {

/// Phase 1: exploring one rig.
struct CollectionConfig {
  std::int64_t seed = 1;
  std::int64_t rig_seed = 1;
  std::int64_t sensor_seed = 1;
  std::int64_t transitions = 34742;  // section V-A
  std::int64_t episode_steps = 25;
  std::int64_t sessions = 1;
  double checkpoint_every_s = 10.0;
  control::ControlLoopConfig loop;
  safety::SafetyConfig safety;
  control::ExplorerConfig explorer;
  rig::RigConfig rig;
  session::SensingConfig sensor;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the exploration and of the sensor's noise", {0, 9e15});
    v.field("rig_seed", rig_seed, "", "seed of what is hidden in the rig: friction map, deviations",
            {0, 9e15});
    v.field("sensor_seed", sensor_seed, "", "seed of the camera's place and calibration", {0, 9e15});
    v.field("transitions", transitions, "", "transitions to record", {1, 1e9});
    v.field(
        "episode_steps", episode_steps, "steps",
        "longest episode; the next one begins where it ended, or where the operator has placed the needle "
        "(explorer.self_reset)",
        {1, 1e6});
    v.field("sessions", sessions, "",
            "explorations of the same rig that know nothing of each other and run side by side on threads; a "
            "real "
            "bench has them one after the other",
            {1, 64});
    v.field("checkpoint_every_s", checkpoint_every_s, "s",
            "how often a virtual exploration can be gone on with; a real one can after every episode",
            {0, 3600});
    v.group("loop", loop, "timing of the control loop");
    v.group("safety", safety, "limits of the supervisor");
    v.group("explorer", explorer, "how the rig is explored");
    v.group("rig", rig, "the rig");
    v.group("sensor", sensor, "how poses are sensed");
  }
};

/// What the dataset's attributes say.
data::DatasetInfo dataset_info(const CollectionConfig& config);

/// Somebody or something at the controls instead of the explorer.
struct Teleoperator {
  control::Controller* controller = nullptr;
  task::ActionConfig action;  ///< what its actions mean in A; by default the rig's largest current
  std::shared_ptr<control::RigIdentifier> identifier;  ///< what tells it how strong the rig is; null: nothing
  std::function<bool()> episode_over;    ///< the operator shall place the needle; asked at every step
  control::ControlLoop::Observer watch;  ///< sees every observation, before its pulse
  std::function<std::string()> save;     ///< its state between two episodes; empty functions: it has none
  std::function<void(const std::string&)> restore;
};

/// The virtual bench of a session.
std::unique_ptr<session::RigSession> make_exploration_session(const CollectionConfig& config,
                                                              std::int64_t session = 0,
                                                              bool realtime = false);

/// Explores one rig, one episode at a time, through the same control loop as deployment.
class Collection {
 public:
  /// `session`: explorer, sensor noise and pulse scatter have random streams of their own in every session.
  explicit Collection(const CollectionConfig& config, std::int64_t session = 0);
  /// On any bench; where there is a teleoperator, the explorer only says where to place the needle.
  Collection(const CollectionConfig& config, std::unique_ptr<session::RigSession> bench,
             std::optional<Teleoperator> teleoperator = {}, std::int64_t session = 0);

  /// The next episode, of at most `max_steps` steps, until the step limit, a needle that needs the operator,
  /// a missing pose, or the teleoperator's word. It begins where the needle lies. Where it could not be
  /// freed or found again, or the teleoperator has ended the episode before, or without `self_reset`, the
  /// operator has placed it first. Observations are sensed poses, actions signed axis currents in A. Throws
  /// Interrupted (the episode is lost) and HardwareError.
  data::Episode next_episode(std::int64_t max_steps);

  /// Logs all that follows in a file, which is flushed after every episode. Throws IoError, as next_episode()
  /// does then.
  void log_into(const std::string& path, const McapConfig& config);
  /// Ends the log, where there is one. Throws IoError.
  void finish_log();

  /// Everything that changes, between two episodes; going on after restore() is bitwise as if never stopped.
  common::Json save() const;
  /// Throws DataError when the state is malformed.
  void restore(const common::Json& state);

 private:
  task::ActionConfig action() const;
  /// Drives, and says whether the needle is to be placed before the next run.
  control::LoopOutcome run(std::int64_t max_steps);
  void note(exports::LogLevel level, const std::string& text);

  CollectionConfig config_;
  std::unique_ptr<session::RigSession> bench_;
  std::optional<Teleoperator> teleoperator_;
  control::Explorer explorer_;
  bool to_be_placed_;
  std::optional<StepLog> log_;
};

}  // namespace lodestone::experiments
