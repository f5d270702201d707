#include "lodestone/console/goal.h"

#include "lodestone/experiments/suture.h"

namespace lodestone::console {

Goal path_goal(const geometry::Path& path, const experiments::DeploymentConfig& config) {
  Goal goal;
  goal.task = "path";
  goal.path = experiments::headed_path(path, config);
  return goal;
}

Goal suture_goal(const experiments::DeploymentConfig& config) {
  experiments::check_stitches(config);
  Goal goal;
  goal.task = "suture";
  goal.stitches = experiments::stitches_of(config.trials.suture);
  goal.path = geometry::way_through_all(goal.stitches, config.suture.approach_m, config.suture.leave_m);
  return goal;
}

}  // namespace lodestone::console
