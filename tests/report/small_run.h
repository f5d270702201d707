#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodestone/common/files.h"
#include "lodestone/report/run_data.h"

namespace lodestone::tests {

inline void write_with_folders(const std::string& path, const std::string& content) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  common::write_file_atomically(path, content);
}

/// Three observations towards a target at the origin, 0.5 mm from it at the end.
inline runs::TrialRecord point_trial(const std::string& controller, const std::string& rig,
                                     std::int64_t number = 0) {
  runs::TrialRecord record;
  record.task = "point";
  record.rig = rig;
  record.controller = controller;
  record.trial = number;
  record.start = {20.0, 10.0, 0.1};
  record.target_mm = {0.0, 0.0};
  record.time_s = {0.0, 0.3, 0.6};
  record.trajectory = {{20.0, 0.0, 0.1}, {5.0, 0.0, 0.2}, {0.5, 0.0, 0.3}};
  record.sensed_trajectory = {runs::PoseMm{20.0, 1.0, 0.1}, std::nullopt, runs::PoseMm{1.0, 0.0, 0.3}};
  record.current_A = {{12.0, 0.0, 0.0, 3.0}, {0.0, 7.5, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  record.temperature_C = {std::nullopt, runs::PerCoil{22.5, 22.0, 22.0, 22.0},
                          runs::PerCoil{22.4, 31.25, 22.0, 22.0}};
  record.log_drive_gain = {std::array<double, 2>{0.0, 0.45}, std::nullopt, std::array<double, 2>{0.3, 0.1}};
  record.truth.emplace().final_error_mm = 0.5;
  record.truth->success = true;
  record.sensed.final_error_mm = 1.0;
  record.completed = true;
  return record;
}

/// Along a straight path, the first two observations on the way to it.
inline runs::TrialRecord path_trial(const std::string& controller, const std::string& rig) {
  runs::TrialRecord record = point_trial(controller, rig);
  record.task = "square";
  record.target_mm.reset();
  record.path_mm = {{0.0, 0.0}, {10.0, 0.0}};
  record.reference_mm = {{0.0, 0.0}, {0.0, 0.0}, {3.5, 4.0}};
  record.approach = {1, 1, 0};
  record.truth->cross_track_rms_mm = 2.25;
  return record;
}

inline report::DeployData deployment(const std::string& rig, const std::string& controller) {
  report::DeployData deploy;
  deploy.rig = rig;
  deploy.summary.controller = controller;
  runs::TaskSummary& summary = deploy.summary.tasks.by_task["point"];
  summary.n_trials = 2;
  summary.truth.emplace().mean_error_mm = 0.625;
  summary.truth->rms_error_mm = 0.75;
  summary.truth->success_rate = 1.0;
  deploy.trials = {point_trial(controller, rig), point_trial(controller, rig, 1)};
  deploy.trials->back().truth->final_error_mm = 7.125;
  deploy.trials->back().truth->success = false;
  return deploy;
}

inline report::RunData small_run() {
  report::RunData run;
  run.rigs = {deployment("explored", "policy")};
  return run;
}

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace lodestone::tests
