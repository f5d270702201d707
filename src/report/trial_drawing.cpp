#include "trial_drawing.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>

#include "lodestone/common/files.h"
#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"

namespace lodestone::report {
namespace {

constexpr double kSuccessRadius_mm = 3.0;
constexpr const char* kTargetColour = "#2f7d4f";

/// The way of the needle: true, or as far as it was seen.
Points track_of(const runs::TrialRecord& trial) {
  Points points;
  if (trial.trajectory) {
    for (const runs::PoseMm& pose : *trial.trajectory) points.emplace_back(pose[0], pose[1]);
    return points;
  }
  for (const auto& pose : trial.sensed_trajectory)
    if (pose) points.emplace_back((*pose)[0], (*pose)[1]);
  return points;
}

void draw_trial(const runs::TrialRecord& trial, const std::string& colour, DishSvg& dish) {
  const Points track = track_of(trial);
  if (track.empty()) return;
  // The way to the start of a path is not scored, and drawn pale.
  std::size_t on_path = 0;
  if (trial.approach)
    while (on_path < trial.approach->size() && on_path < track.size() && trial.approach->at(on_path) == 1)
      ++on_path;
  const auto split = track.begin() + static_cast<std::ptrdiff_t>(on_path);
  if (on_path > 0) dish.line(Points(track.begin(), std::min(split + 1, track.end())), "#9aa5b0", 0.45, 0.6);
  dish.line(Points(split, track.end()), colour, 0.55, 0.6);
  dish.dot(track.front().first, track.front().second, 0.9, colour, true, 0.9);
  dish.dot(track.back().first, track.back().second, 0.95, colour);
}

}  // namespace

std::string draw_trials(const std::vector<runs::TrialRecord>& trials, const std::string& task,
                        const std::string& controller, double radius_mm) {
  DishSvg dish(radius_mm, true);
  std::vector<const runs::TrialRecord*> chosen;
  for (const runs::TrialRecord& trial : trials)
    if (trial.task == task && trial.controller == controller && chosen.size() < kDrawnTrials)
      chosen.push_back(&trial);
  if (chosen.empty()) return "";
  if (const auto& path = chosen.front()->path_mm) {
    Points points;
    for (const runs::PointMm& point : *path) points.emplace_back(point[0], point[1]);
    dish.line(points, kTargetColour, 0.7, 0.9, true);
  }
  const std::string colour = controller == "baseline" ? kBaselineColour : kPolicyColour;
  std::set<runs::PointMm> marked;
  for (const runs::TrialRecord* trial : chosen) {
    draw_trial(*trial, colour, dish);
    if (trial->target_mm && marked.insert(*trial->target_mm).second)
      dish.target((*trial->target_mm)[0], (*trial->target_mm)[1], kSuccessRadius_mm, kTargetColour);
  }
  return dish.svg("Trajectories: " + task + ", " + controller);
}

void write_svg(const std::string& path, const std::string& drawing) {
  constexpr std::string_view kTag = "<svg ";
  if (drawing.rfind(kTag, 0) != 0) return;
  common::make_folders(std::filesystem::path(path).parent_path().string());
  common::write_file_atomically(
      path, "<svg xmlns=\"http://www.w3.org/2000/svg\" " + drawing.substr(kTag.size()) + "\n");
}

}  // namespace lodestone::report
