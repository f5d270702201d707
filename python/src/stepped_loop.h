#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "lodestone/control/control_loop.h"
#include "lodestone/session/rig_session.h"

namespace lodestone::python {

/// The control loop of a rig, asked for one step at a time: it runs in a thread of its own, as it always
/// does, and waits for the next action where a controller would decide. On a rig whose time passes by itself
/// whoever dawdles misses the loop's deadlines. One thread asks.
class SteppedLoop {
 public:
  /// All must outlive it. `action` must map to amperes.
  SteppedLoop(session::RigSession& rig, const control::ControlLoopConfig& config,
              const task::ActionConfig& action, const physics::RigDescription& description);
  ~SteppedLoop() { end(); }
  SteppedLoop(const SteppedLoop&) = delete;
  SteppedLoop& operator=(const SteppedLoop&) = delete;

  /// Begins a run: the first pose that is sensed, or nothing where the run was stopped before.
  std::optional<geometry::Pose2> begin();
  /// Gives a pulse: the next pose that is sensed, or nothing where the run was stopped.
  std::optional<geometry::Pose2> step(const geometry::Drive& action);
  /// Ends the run, with the coils off.
  void end();
  /// Why the last run was stopped.
  const std::string& stop_reason() const { return stop_reason_; }

 private:
  class Handover;
  std::optional<geometry::Pose2> wait_for_pose();
  geometry::Drive hand_over(const geometry::Pose2& pose);

  control::ControlLoop loop_;
  std::thread thread_;
  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::optional<geometry::Pose2> pose_;    ///< that waits for an action
  std::optional<geometry::Drive> action_;  ///< that the loop has not taken yet
  bool ending_ = false;
  bool running_ = false;
  std::string stop_reason_;
};

}  // namespace lodestone::python
