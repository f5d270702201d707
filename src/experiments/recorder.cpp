#include "lodestone/experiments/recorder.h"

#include <cmath>
#include <iomanip>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::experiments {

namespace {

std::string heading(bool true_poses) {
  return std::string("rig,controller,task,trial,t_s,") +
         (true_poses ? "true_x_m,true_y_m,true_heading_rad," : "") +
         "sensed,sensed_x_m,sensed_y_m,sensed_heading_rad,target_x_m,target_y_m,approach,action_x,action_y,"
         "current_px_A,current_mx_A,current_py_A,current_my_A\n";
}

runs::PoseMm pose_mm(const geometry::Pose2& pose) {
  return {geometry::kMmPerM * pose.x_m, geometry::kMmPerM * pose.y_m, pose.heading_rad};
}

runs::PointMm point_mm(const geometry::Vector2& point_m) {
  return {geometry::kMmPerM * point_m.x(), geometry::kMmPerM * point_m.y()};
}

/// The first rows of a file that may end in the middle of one.
std::string first_rows(const std::string& path, std::int64_t rows) {
  std::ifstream file(path);
  std::string kept;
  std::string line;
  for (std::int64_t i = 0; i <= rows && std::getline(file, line); ++i)
    kept += line + "\n";  // and the heading
  return kept;
}

void write_pose(std::ostream& out, const std::optional<geometry::Pose2>& pose) {
  if (pose)
    out << pose->x_m << ',' << pose->y_m << ',' << pose->heading_rad << ',';
  else
    out << ",,,";
}

}  // namespace

Recorder::Recorder(const std::string& file, bool true_poses, std::int64_t keep_rows)
    : path_(file), true_poses_(true_poses) {
  common::write_file_atomically(file, keep_rows > 0 ? first_rows(file, keep_rows) : heading(true_poses));
  file_.open(file, std::ios::app);
  if (!file_) throw common::IoError("cannot write " + path_ + ": check the folder and the space on the disk");
  file_ << std::setprecision(9);
}

void Recorder::write(const TrialResult& result) {
  for (const TrialSample& sample : result.samples) {
    const control::StepRecord& step = sample.step;
    file_ << result.rig << ',' << result.controller << ',' << result.plan.task << ',' << result.plan.index
          << ',' << step.time_s << ',';
    if (true_poses_) write_pose(file_, sample.true_pose);
    file_ << (step.estimate.valid ? 1 : 0) << ',';
    write_pose(file_, step.estimate.valid ? std::optional(step.estimate.pose) : std::nullopt);
    file_ << step.target_m.x() << ',' << step.target_m.y() << ',' << (sample.approach ? 1 : 0) << ','
          << step.action.x() << ',' << step.action.y();
    for (const double current_A : step.current_A) file_ << ',' << current_A;
    file_ << '\n';
  }
  file_.flush();
  if (!file_) throw common::IoError("cannot write " + path_ + ": check the space on the disk");
}

runs::TrialRecord record_of(const TrialResult& result) {
  const TrialPlan& plan = result.plan;
  runs::TrialRecord record;
  record.task = plan.task;
  record.rig = result.rig;
  record.controller = result.controller;
  record.trial = plan.index;
  record.start = pose_mm(plan.start);
  record.target_heading_rad = plan.target_heading_rad;
  record.completed = result.completed;
  record.stop_reason = result.stop_reason;
  record.truth = result.truth;
  record.sensed = result.sensed;
  if (plan.path) {
    record.path_mm.emplace();
    for (const geometry::Vector2& point_m : plan.path->points_m())
      record.path_mm->push_back(point_mm(point_m));
    record.reference_mm.emplace();
    record.approach.emplace();
  } else {
    record.target_mm = point_mm(plan.target_m);
  }
  if (result.truth) record.trajectory.emplace();
  record.current_A.emplace();
  const bool temperatures = !result.samples.empty() && result.samples.back().temperature_C;
  if (temperatures) record.temperature_C.emplace();
  for (const TrialSample& sample : result.samples) {
    record.time_s.push_back(sample.step.time_s);
    if (record.trajectory) record.trajectory->push_back(pose_mm(*sample.true_pose));
    const control::PoseEstimate& estimate = sample.step.estimate;
    record.sensed_trajectory.push_back(estimate.valid ? std::optional(pose_mm(estimate.pose)) : std::nullopt);
    record.current_A->push_back(sample.step.current_A);
    // Before the first pulse nothing has been reported.
    if (temperatures) record.temperature_C->push_back(sample.temperature_C);
    if (!plan.path) continue;
    record.reference_mm->push_back(point_mm(sample.step.target_m));
    record.approach->push_back(sample.approach ? 1 : 0);
  }
  return record;
}

}  // namespace lodestone::experiments
