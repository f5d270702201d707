#include "trial_drawing.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "lodestone/common/files.h"
#include "lodestone/geometry/stitch.h"
#include "lodestone/report/charts.h"

namespace lodestone::report {
namespace {

constexpr double kTick_mm = 3.0;        // along a wanted heading,
constexpr double kTicksApart_mm = 4.0;  // at least
constexpr const char* kTargetColour = "#2f7d4f";
constexpr const char* kApproachColour = "#9aa5b0";
constexpr const char* kUnseenColour = "#d55e00";
constexpr const char* kRouteColour = "#5b6773";

void draw_trial(const Trial& trial, DishSvg& dish) {
  const Points& track = trial.track_mm;
  if (track.empty()) return;
  const std::string colour = colour_of(trial.controller);
  const auto at = [&track](std::size_t i) {
    return track.begin() + static_cast<std::ptrdiff_t>(std::min(i, track.size()));
  };
  Points route = {track.front()};
  route.insert(route.end(), trial.route_mm.begin(), trial.route_mm.end());
  dish.line(route, kRouteColour, 0.4, 0.7, true);
  if (trial.approach > 0)
    dish.line(Points(track.begin(), at(trial.approach + 1)), kApproachColour, 0.45, 0.6);
  dish.line(Points(at(trial.approach), track.end()), colour, 0.55, 0.6);
  for (std::size_t i = 0; i < std::min(track.size(), trial.unseen.size()); ++i)
    if (trial.unseen[i]) dish.dot(track[i].first, track[i].second, 0.5, kUnseenColour);
  dish.dot(track.front().first, track.front().second, 0.9, colour, true, 0.9);
  dish.dot(track.back().first, track.back().second, 0.95, colour);
}

/// How the needle should lie at a point.
void draw_heading(const std::pair<double, double>& at_mm, double heading_rad, DishSvg& dish) {
  const auto& [x_mm, y_mm] = at_mm;
  const std::pair<double, double> end_mm(x_mm + kTick_mm * std::cos(heading_rad),
                                         y_mm + kTick_mm * std::sin(heading_rad));
  dish.line({at_mm, end_mm}, kTargetColour, 0.5, 0.9);
}

/// The same along a path that has headings, without the approach.
void draw_path_headings(const Trial& trial, DishSvg& dish) {
  const std::size_t known = std::min(trial.reference_mm.size(), trial.reference_heading_rad.size());
  std::optional<std::pair<double, double>> last_mm;
  for (std::size_t i = trial.approach; i < known; ++i) {
    const std::pair<double, double>& at_mm = trial.reference_mm[i];
    if (last_mm && std::hypot(at_mm.first - last_mm->first, at_mm.second - last_mm->second) < kTicksApart_mm)
      continue;
    draw_heading(at_mm, trial.reference_heading_rad[i], dish);
    last_mm = at_mm;
  }
}

geometry::Pose2 pose_m(const runs::PoseMm& pose_mm) {
  return {pose_mm[0] / geometry::kMmPerM, pose_mm[1] / geometry::kMmPerM, pose_mm[2]};
}

/// From entry to exit, with how the needle should lie at both.
void draw_stitches(const Trial& trial, DishSvg& dish) {
  for (const runs::StitchRecord& stitch : trial.stitches) {
    const geometry::Path way = geometry::way_through({pose_m(stitch.entry), pose_m(stitch.exit)}, 0.0, 0.0);
    Points thread;
    for (const geometry::Vector2& point_m : way.points_m())
      thread.emplace_back(geometry::kMmPerM * point_m.x(), geometry::kMmPerM * point_m.y());
    dish.line(thread, kTargetColour, 0.7, 0.9);
    for (const runs::PoseMm& end : {stitch.entry, stitch.exit}) draw_heading({end[0], end[1]}, end[2], dish);
    dish.dot(stitch.entry[0], stitch.entry[1], 0.6, kTargetColour, true);
    dish.dot(stitch.exit[0], stitch.exit[1], 0.6, kTargetColour);
  }
}

void draw_targets(const std::vector<const Trial*>& trials, DishSvg& dish) {
  Points marked;
  for (const Trial* trial : trials) {
    if (trial->target_mm && trial->target_heading_rad)
      draw_heading(*trial->target_mm, *trial->target_heading_rad, dish);
    if (!trial->target_mm || std::find(marked.begin(), marked.end(), *trial->target_mm) != marked.end())
      continue;
    marked.push_back(*trial->target_mm);
    dish.target(trial->target_mm->first, trial->target_mm->second, trial->success_radius_mm, kTargetColour);
  }
}

}  // namespace

std::string colour_of(const std::string& controller) {
  if (controller == "baseline") return kBaselineColour;
  if (controller == "observer") return kObserverColour;
  return controller == "planner" ? kSecondColour : kPolicyColour;
}

std::string draw_trials(const std::vector<const Trial*>& trials, const DrawnRig& rig,
                        const std::string& label) {
  if (trials.empty()) return "";
  const std::vector<const Trial*> drawn(
      trials.begin(), trials.begin() + static_cast<std::ptrdiff_t>(std::min(trials.size(), kDrawnTrials)));
  DrawnRig around = rig;
  if (drawn.size() == 1)
    for (const std::vector<DrawnZone>* own : {&drawn.front()->obstacles, &drawn.front()->told_zones})
      around.keep_out.insert(around.keep_out.end(), own->begin(), own->end());
  DishSvg dish(around, true);
  dish.line(drawn.front()->path_mm, kTargetColour, 0.7, 0.9, true);
  if (drawn.front()->stitches.empty()) draw_path_headings(*drawn.front(), dish);
  draw_stitches(*drawn.front(), dish);
  for (const Trial* trial : drawn) draw_trial(*trial, dish);
  draw_targets(drawn, dish);
  return dish.svg(label);
}

void write_svg(const std::string& path, const std::string& drawing) {
  if (drawing.empty()) return;
  common::make_folders(std::filesystem::path(path).parent_path().string());
  common::write_file_atomically(path, drawing + "\n");
}

std::string legend_of(const std::vector<const Trial*>& trials) {
  const auto any = [&trials](auto what) {
    return std::any_of(trials.begin(), trials.end(), [&](const Trial* trial) { return what(*trial); });
  };
  std::string text = "Rings: starts; dots: ends";
  const auto to_a_target = std::find_if(trials.begin(), trials.end(),
                                        [](const Trial* trial) { return trial->target_mm.has_value(); });
  if (to_a_target != trials.end())
    text += fmt::format("; green circles: the {:g} mm around a target that count as reached",
                        (*to_a_target)->success_radius_mm);
  if (any([](const Trial& trial) { return !trial.path_mm.empty(); })) text += "; green, dashed: the path";
  if (any([](const Trial& trial) { return !trial.stitches.empty(); }))
    text += "; green lines: stitches, from a ring where the needle goes in to a dot where it comes out";
  if (any([](const Trial& trial) {
        return trial.target_heading_rad.has_value() || !trial.reference_heading_rad.empty();
      }))
    text += "; green ticks: where the needle's head should point";
  if (any([](const Trial& trial) { return trial.approach > 0; }))
    text += "; grey lines: the way to the start of a path or to a first stitch, which is not scored";
  if (trials.size() == 1 && !trials.front()->told_zones.empty())
    text += "; red: zones to keep out of, as they were told at first and at last";
  if (any([](const Trial& trial) { return !trial.route_mm.empty(); }))
    text += "; grey, dashed: the points that it was led over";
  const auto blind = [](const Trial& trial) {
    return std::find(trial.unseen.begin(), trial.unseen.end(), true) != trial.unseen.end();
  };
  if (any(blind)) text += "; orange dots: moments at which the needle was not seen";
  return text + ".";
}

}  // namespace lodestone::report
