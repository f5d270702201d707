#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/report/dish_svg.h"
#include "lodestone/report/run_data.h"

namespace lodestone::report {

/// One trial as it is drawn. Lists go by observation.
struct Trial {
  std::string task;
  std::string rig;         ///< "explored", "unseen" or "real"
  std::string controller;  ///< "policy", "planner", "baseline" or "observer"
  std::int64_t number = 0;
  Points path_mm;                                      ///< empty for points
  std::vector<runs::StitchRecord> stitches = {};       ///< of a suture
  std::optional<std::pair<double, double>> target_mm;  ///< none for paths
  Points route_mm;                         ///< that the needle was led over; empty where no way was searched
  std::vector<DrawnZone> obstacles = {};   ///< that were drawn for it alone
  std::vector<DrawnZone> told_zones = {};  ///< by a file, each once: those at its begin and at its end
  Points track_mm;                         ///< true positions, or as sensed where nobody knows them
  bool track_is_true = true;
  std::vector<bool> unseen;  ///< whether there was no pose
  Points reference_mm;       ///< where it should have been; the target, or the moving point of a path
  std::vector<double> reference_heading_rad = {};  ///< and how it should have lain; empty: any way
  std::optional<double> target_heading_rad = {};   ///< likewise, of a pose
  std::optional<double> heading_rms_deg = {};      ///< of a suture, or a path that has headings
  std::size_t approach =
      0;  ///< so many observations at the start are the way to a path or a first stitch, not scored
  std::vector<double> time_s;
  std::vector<std::vector<double>> current_A;      ///< of each coil; empty when not recorded
  std::vector<std::vector<double>> temperature_C;  ///< likewise
  /// Mean and standard deviation of the logarithm of the drive's gain; NaN without a pose, empty when the rig
  /// was not identified.
  std::vector<std::array<double, 2>> log_drive_gain;
  double error_mm = 0.0;  ///< runs::TrialFigures::error_mm()
  bool success = false;
  double success_radius_mm = 3.0;  ///< around a target
  bool completed = true;
  std::string stop_reason;
  std::optional<double> rig_changed_s;   ///< when its rig was told to be another
  std::optional<double> camera_moved_s;  ///< when its camera no longer stood where it was calibrated

  /// Distance to the reference at an observation.
  double distance_mm(std::size_t observation) const;
};

std::vector<Trial> read_trials(const std::vector<runs::TrialRecord>& records);
/// The trials of one kind of rig; none where their list is missing.
std::vector<Trial> read_trials(const DeployData& deploy);

/// Those of one task by one controller.
std::vector<const Trial*> select(const std::vector<Trial>& trials, const std::string& task,
                                 const std::string& controller);

/// The controllers in order of appearance.
std::vector<std::string> controllers_of(const std::vector<Trial>& trials);

}  // namespace lodestone::report
