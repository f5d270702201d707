#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lodestone/control/control_loop.h"
#include "lodestone/control/explorer.h"
#include "lodestone/control/safety_supervisor.h"
#include "lodestone/control/sensing.h"
#include "lodestone/data/dataset.h"
#include "lodestone/rig/virtual_rig.h"

namespace lodestone::control {

/// Phase 1: exploring one virtual rig.
struct CollectionConfig {
  std::int64_t seed = 1;
  std::int64_t rig_seed = 1;
  std::int64_t sensor_seed = 1;
  std::int64_t transitions = 34742;  // section V-A
  std::int64_t episode_steps = 25;
  std::int64_t sessions = 1;
  ControlLoopConfig loop;
  SafetyConfig safety;
  ExplorerConfig explorer;
  rig::VirtualRigConfig rig;
  SensingConfig sensor;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the exploration and of the sensor's noise", {0, 9e15});
    v.field("rig_seed", rig_seed, "", "seed of the rig's friction map", {0, 9e15});
    v.field("sensor_seed", sensor_seed, "", "seed of the camera's place and calibration", {0, 9e15});
    v.field("transitions", transitions, "", "transitions to record", {1, 1e9});
    v.field("episode_steps", episode_steps, "steps", "longest stretch between two resets by the operator",
            {1, 1e6});
    v.field("sessions", sessions, "",
            "explorations of the same rig that know nothing of each other and run side by side on threads; a "
            "real "
            "bench has them one after the other",
            {1, 64});
    v.group("loop", loop, "timing of the control loop");
    v.group("safety", safety, "limits of the supervisor");
    v.group("explorer", explorer, "how the rig is explored");
    v.group("rig", rig, "the virtual rig");
    v.group("sensor", sensor, "how poses are sensed");
  }
};

/// What the dataset's attributes say.
data::DatasetInfo dataset_info(const CollectionConfig& config);

/// The first `steps` steps of an episode, truncated there.
data::Episode first_steps(const data::Episode& episode, std::int64_t steps);

/// Explores one virtual rig, one episode at a time, through the same control loop as deployment.
class Collection {
 public:
  /// `session`: explorer, sensor noise and pulse scatter have random streams of their own in every session.
  explicit Collection(const CollectionConfig& config, std::int64_t session = 0);

  /// The next episode, of at most `max_steps` steps: from where the operator laid the needle until the step
  /// limit, a stuck needle, or a missing pose. Observations are sensed poses, actions signed axis currents in
  /// A. Throws Interrupted (the episode is lost) and HardwareError.
  data::Episode next_episode(std::int64_t max_steps);

  /// Everything that changes, between two episodes; going on after restore() is bitwise as if never stopped.
  common::Json save() const;
  /// Throws DataError when the state is malformed.
  void restore(const common::Json& state);

 private:
  CollectionConfig config_;
  rig::VirtualRig rig_;
  Sensing sensing_;
  std::unique_ptr<RigSensor> sensor_;
  SafetySupervisor coils_;
  Explorer explorer_;
};

}  // namespace lodestone::control
