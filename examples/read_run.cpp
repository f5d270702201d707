// Reads a finished run of `lodestone deploy` and measures it anew from its trials, beside the figures that it
// has written.
//
//   build/examples/read_run runs/deploy
//
// Of a point the error is the distance to it at the end, of a path the RMS distance to its line.
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/path.h"
#include "lodestone/report/run_data.h"
#include "lodestone/runs/run_folder.h"

using namespace lodestone;

/// In mm, as the file; by true poses, which only a virtual rig knows.
double error_mm(const runs::TrialRecord& trial) {
  const auto position = [&](std::size_t i) { return geometry::Vector2(trial.trajectory->at(i).data()); };
  if (trial.target_mm)
    return (position(trial.time_s.size() - 1) - geometry::Vector2(trial.target_mm->data())).norm();
  std::vector<geometry::Vector2> corners;
  for (const runs::PointMm& corner : *trial.path_mm) corners.emplace_back(corner.data());
  const geometry::Path path(corners, false);
  std::vector<double> off_mm;
  for (std::size_t i = 0; i < trial.time_s.size(); ++i)
    if (trial.approach->at(i) == 0) off_mm.push_back(path.nearest(position(i)).distance_m);
  return common::root_mean_square(off_mm);
}

int main(int count, char** words) try {
  if (count != 2) throw common::ConfigError("usage: read_run DIR");
  const auto state = runs::find_run(words[1]);
  if (!state || !state->finished) throw common::DataError(std::string(words[1]) + " holds no finished run");
  const report::RunData run = report::read_run(words[1]);
  for (const report::DeployData& rig : run.rigs) {
    std::map<std::pair<std::string, std::string>, std::vector<double>> errors_mm;
    for (const runs::TrialRecord& trial : rig.trials.value())
      errors_mm[{trial.controller, trial.task}].push_back(error_mm(trial));
    for (const auto& [what, errors] : errors_mm) {
      const auto& [controller, task] = what;
      const auto& table = controller == "baseline" ? *rig.summary.baseline : rig.summary.tasks;
      std::printf("%s %s %s %.6f mm, deploy wrote %.6f mm\n", rig.rig.c_str(), controller.c_str(),
                  task.c_str(), common::mean(errors), table.by_task.at(task).truth.value().mean_error_mm);
    }
  }
} catch (const common::Error& error) {
  std::fprintf(stderr, "read_run: %s\n", error.what());
  return 1;
}
