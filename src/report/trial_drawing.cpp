#include "trial_drawing.h"

#include <algorithm>
#include <vector>

#include "lodestone/report/charts.h"
#include "lodestone/report/dish_svg.h"

namespace lodestone::report {
namespace {

using common::Json;

constexpr double kSuccessRadius_mm = 3.0;
constexpr const char* kTargetColour = "#2f7d4f";

Points points_of(const Json& list) {
  Points points;
  if (!list.is_array()) return points;
  for (const Json& entry : list)
    if (entry.is_array() && entry.size() >= 2 && entry[0].is_number() && entry[1].is_number())
      points.emplace_back(entry[0].get<double>(), entry[1].get<double>());
  return points;
}

const Json& member(const Json& json, const char* key, const char* other) {
  static const Json kNothing;
  if (json.contains(key)) return json.at(key);
  return json.contains(other) ? json.at(other) : kNothing;
}

std::string task_of(const Json& trial) {
  return trial.is_object() && trial.contains("task") && trial["task"].is_string()
             ? trial["task"].get<std::string>()
             : "";
}

std::string controller_of(const Json& trial) {
  const bool named = trial.contains("controller") && trial["controller"].is_string();
  return named && trial["controller"].get<std::string>() == "baseline" ? "baseline" : "policy";
}

void draw_trial(const Json& trial, const std::string& colour, DishSvg& dish) {
  const Points track = points_of(member(trial, "trajectory", "sensed_trajectory"));
  if (track.empty()) return;
  // The way to the start of a path is not scored, and drawn pale.
  std::size_t on_path = 0;
  if (trial.contains("approach") && trial["approach"].is_array())
    while (on_path < trial["approach"].size() && on_path < track.size() && trial["approach"][on_path] == 1)
      ++on_path;
  const auto split = track.begin() + static_cast<std::ptrdiff_t>(on_path);
  if (on_path > 0) dish.line(Points(track.begin(), std::min(split + 1, track.end())), "#9aa5b0", 0.45, 0.6);
  dish.line(Points(split, track.end()), colour, 0.55, 0.6);
  dish.dot(track.front().first, track.front().second, 0.9, colour, true, 0.9);
  dish.dot(track.back().first, track.back().second, 0.95, colour);
}

}  // namespace

std::string draw_trials(const Json& trials, const std::string& task, const std::string& controller,
                        double radius_mm) {
  DishSvg dish(radius_mm, true);
  std::vector<const Json*> chosen;
  for (const Json& trial : trials)
    if (task_of(trial) == task && controller_of(trial) == controller && chosen.size() < kDrawnTrials)
      chosen.push_back(&trial);
  if (chosen.empty()) return "";
  const Points path = points_of(member(*chosen.front(), "path_mm", "path"));
  dish.line(path, kTargetColour, 0.7, 0.9, true);
  const std::string colour = controller == "baseline" ? kBaselineColour : kPolicyColour;
  for (const Json* trial : chosen) draw_trial(*trial, colour, dish);
  if (path.empty()) {
    Points marked;
    for (const Json* trial : chosen) {
      const Points target = points_of(Json::array({member(*trial, "target_mm", "target")}));
      if (target.empty() || std::find(marked.begin(), marked.end(), target.front()) != marked.end()) continue;
      marked.push_back(target.front());
      dish.target(target.front().first, target.front().second, kSuccessRadius_mm, kTargetColour);
    }
  }
  return dish.svg("Trajectories: " + task + ", " + controller);
}

}  // namespace lodestone::report
