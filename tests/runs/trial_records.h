#pragma once

#include <string>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::tests {

/// A trial that ended at a distance from its target.
inline runs::TrialRecord point_trial(std::int64_t trial, double error_mm,
                                     const std::string& controller = "policy",
                                     const std::string& rig = "unseen") {
  runs::TrialRecord made;
  made.task = "point";
  made.rig = rig;
  made.controller = controller;
  made.trial = trial;
  made.start = {1.0 + static_cast<double>(trial), -2.0, 0.5};
  made.target_mm = runs::PointMm{3.0, static_cast<double>(trial)};
  made.time_s = {0.0};
  made.sensed_trajectory = {made.start};
  made.completed = true;
  made.sensed.final_error_mm = error_mm;
  made.sensed.success = error_mm <= 3.0;
  if (made.sensed.success) made.sensed.seconds_to_reach = 2.0 + error_mm;
  return made;
}

/// A folder as deploy leaves it.
inline void write_deployment(const std::string& folder, std::vector<runs::TrialRecord> trials,
                             std::int64_t per_rig = 0, std::int64_t seed = 1) {
  common::make_folders(folder);
  common::Json list = common::Json::array();
  for (runs::TrialRecord& trial : trials) list.push_back(common::artefact_to_json(trial));
  common::write_json(folder + "/" + runs::kTrialsFile, list);
  common::write_json(folder + "/config.json",
                     {{"seed", seed}, {"threads", seed + 1}, {"trials", {{"per_rig", per_rig}}}});
}

}  // namespace lodestone::tests
