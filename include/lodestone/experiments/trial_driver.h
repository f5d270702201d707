#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "lodestone/experiments/deployment.h"

namespace lodestone::experiments {

/// Where trials are driven: on virtual rigs, several at a time, or on one that is connected, one after the
/// other.
struct TrialDriver {
  /// Trials that are driven one after the other are seen by the watch while they are.
  std::function<std::vector<TrialResult>(const std::vector<TrialPlan>&, RigKind, const ControllerSource&,
                                         const TrialWatch&)>
      drive;
  std::function<bool(const geometry::Pose2&)> fits;  ///< whether a start lies inside the dish
  std::function<std::string()> stopped;              ///< why nothing more can be driven; empty when it can
  std::size_t batch = 1;                             ///< trials driven together
};

/// Virtual rigs on `threads` threads (0: one per processor; with `realtime` one trial at a time).
TrialDriver virtual_driver(const DeploymentConfig& config, std::int64_t threads, bool realtime,
                           const TrialFolders& folders = {});

/// A connected rig, which must outlive the driver. `ask_to_place`: somebody places the needle before each
/// trial.
TrialDriver session_driver(session::RigSession& rig, const DeploymentConfig& config, bool ask_to_place,
                           const TrialFolders& folders = {});

}  // namespace lodestone::experiments
