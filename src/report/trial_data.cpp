#include "trial_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::report {
namespace {

std::pair<double, double> point(const runs::PointMm& at) { return {at[0], at[1]}; }

Points points_of(const std::optional<std::vector<runs::PointMm>>& list) {
  Points points;
  if (list)
    for (const runs::PointMm& at : *list) points.push_back(point(at));
  return points;
}

/// True positions, or those that were sensed; one that was not found is where the one before was.
Points track_of(const runs::TrialRecord& record) {
  Points points;
  if (record.trajectory)
    for (const runs::PoseMm& pose : *record.trajectory) points.emplace_back(pose[0], pose[1]);
  if (record.trajectory) return points;
  std::pair<double, double> seen{record.start[0], record.start[1]};
  for (const auto& pose : record.sensed_trajectory) {
    if (pose) seen = {(*pose)[0], (*pose)[1]};
    points.push_back(seen);
  }
  return points;
}

bool contains(const std::vector<DrawnZone>& zones, const DrawnZone& one) {
  return std::any_of(zones.begin(), zones.end(), [&one](const DrawnZone& each) {
    return each.corners_mm == one.corners_mm && each.radius_mm == one.radius_mm;
  });
}

Trial read_trial(const runs::TrialRecord& record) {
  Trial trial;
  trial.task = record.task;
  trial.rig = record.rig;
  trial.controller = record.controller;
  trial.number = record.trial;
  trial.path_mm = points_of(record.path_mm);
  if (record.stitches) trial.stitches = *record.stitches;
  trial.route_mm = points_of(record.route_mm);
  if (record.obstacles_mm)
    for (const runs::DiscMm& disc : *record.obstacles_mm)
      trial.obstacles.push_back({{{disc[0], disc[1]}}, disc[2]});
  if (record.told_zones && !record.told_zones->empty())
    for (const runs::ToldZonesRecord* told : {&record.told_zones->front(), &record.told_zones->back()})
      for (const runs::ZoneRecord& zone : told->zones) {
        const DrawnZone drawn{points_of(zone.corners_mm), zone.radius_mm};
        if (!contains(trial.told_zones, drawn) && !contains(trial.obstacles, drawn))
          trial.told_zones.push_back(drawn);
      }
  if (record.target_mm) trial.target_mm = point(*record.target_mm);
  trial.track_is_true = record.trajectory.has_value();
  trial.track_mm = track_of(record);
  for (const auto& pose : record.sensed_trajectory) trial.unseen.push_back(!pose.has_value());
  trial.reference_mm = points_of(record.reference_mm);
  if (trial.reference_mm.empty() && trial.target_mm)
    trial.reference_mm.assign(trial.track_mm.size(), *trial.target_mm);
  if (record.reference_heading_rad) trial.reference_heading_rad = *record.reference_heading_rad;
  trial.target_heading_rad = record.target_heading_rad;
  if (record.approach)
    while (trial.approach < record.approach->size() && record.approach->at(trial.approach) == 1)
      ++trial.approach;
  if (record.time_s.size() == trial.track_mm.size()) trial.time_s = record.time_s;
  if (record.current_A) trial.current_A = *record.current_A;
  if (record.temperature_C) {
    for (const auto& row : *record.temperature_C)
      trial.temperature_C.push_back(row.value_or(runs::PerCoil{}));
  }
  if (record.log_drive_gain) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (const auto& row : *record.log_drive_gain)
      trial.log_drive_gain.push_back(row.value_or(std::array<double, 2>{kNone, kNone}));
  }
  const runs::TrialFigures& figures = record.figures();
  trial.error_mm = figures.error_mm();
  trial.heading_rms_deg = figures.heading_rms_deg;
  trial.success = figures.success;
  trial.completed = record.completed;
  trial.stop_reason = record.stop_reason;
  trial.rig_changed_s = record.rig_changed_s;
  trial.camera_moved_s = record.camera_moved_s;
  return trial;
}

}  // namespace

double Trial::distance_mm(std::size_t observation) const {
  if (observation >= reference_mm.size()) return std::numeric_limits<double>::quiet_NaN();
  const auto& [x, y] = track_mm.at(observation);
  const auto& [target_x, target_y] = reference_mm.at(observation);
  return std::hypot(x - target_x, y - target_y);
}

std::vector<Trial> read_trials(const std::vector<runs::TrialRecord>& records) {
  std::vector<Trial> trials;
  for (const runs::TrialRecord& record : records) trials.push_back(read_trial(record));
  return trials;
}

std::vector<Trial> read_trials(const DeployData& deploy) {
  if (!deploy.trials) return {};
  std::vector<Trial> trials = read_trials(*deploy.trials);
  for (Trial& trial : trials) trial.success_radius_mm = deploy.success_radius_mm;
  return trials;
}

std::vector<const Trial*> select(const std::vector<Trial>& trials, const std::string& task,
                                 const std::string& controller) {
  std::vector<const Trial*> chosen;
  for (const Trial& trial : trials)
    if (trial.task == task && trial.controller == controller) chosen.push_back(&trial);
  return chosen;
}

std::vector<std::string> controllers_of(const std::vector<Trial>& trials) {
  std::vector<std::string> names;
  for (const Trial& trial : trials)
    if (std::find(names.begin(), names.end(), trial.controller) == names.end())
      names.push_back(trial.controller);
  return names;
}

}  // namespace lodestone::report
