#include "lodestone/experiments/recorder.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iomanip>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/geometry/drive.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::experiments {

namespace {

std::string heading(bool true_poses, const std::vector<std::string>& coils, int action_size) {
  std::string actions, currents;
  for (int i = 0; i < action_size; ++i) actions += "action_" + geometry::number_name(i, action_size) + ",";
  for (const std::string& coil : coils) currents += "current_" + coil + "_A,";
  return std::string("rig,controller,task,trial,t_s,") +
         (true_poses ? "true_x_m,true_y_m,true_heading_rad," : "") +
         "sensed,sensed_x_m,sensed_y_m,sensed_heading_rad,target_x_m,target_y_m,approach," + actions +
         currents + "log_drive_gain,log_drive_gain_sigma,rig_changed,camera_moved\n";
}

runs::PoseMm pose_mm(const geometry::Pose2& pose) {
  return {geometry::kMmPerM * pose.x_m, geometry::kMmPerM * pose.y_m, pose.heading_rad};
}

runs::PointMm point_mm(const geometry::Vector2& point_m) {
  return {geometry::kMmPerM * point_m.x(), geometry::kMmPerM * point_m.y()};
}

/// The rows of a file that may end in the middle of one, and how many of its bytes are the first of them.
struct Rows {
  std::string text;
  std::size_t kept_bytes = 0;
};

Rows read_rows(const std::string& path, std::int64_t keep) {
  Rows rows;
  if (!std::filesystem::exists(path)) return rows;
  rows.text = common::read_file(path);
  rows.text.resize(rows.text.rfind('\n') + 1);
  for (std::int64_t i = 0; i <= keep; ++i) {  // and the heading
    const std::size_t end = rows.text.find('\n', rows.kept_bytes);
    if (end == std::string::npos && keep == 0) break;
    if (end == std::string::npos)
      throw common::DataError(path + " holds fewer rows than the " + std::to_string(keep) +
                              " of the trials that have ended; start again in another folder");
    rows.kept_bytes = end + 1;
  }
  return rows;
}

/// Appends what a trial that was cut short has left.
void set_aside(const std::string& file, const std::string& heading, const std::string& rows) {
  const std::filesystem::path path(file);
  const std::string aside =
      path.parent_path() / (path.stem().string() + "_cut_short" + path.extension().string());
  const std::string before = std::filesystem::exists(aside) ? common::read_file(aside) : heading;
  common::write_file_atomically(aside, before + rows);
}

void write_pose(std::ostream& out, const std::optional<geometry::Pose2>& pose) {
  if (pose)
    out << pose->x_m << ',' << pose->y_m << ',' << pose->heading_rad << ',';
  else
    out << ",,,";
}

}  // namespace

Recorder::Recorder(const std::string& file, bool true_poses, std::int64_t keep_rows,
                   const std::vector<std::string>& coils, int action_size)
    : path_(file), true_poses_(true_poses) {
  const std::string first = heading(true_poses, coils, action_size);
  const Rows rows = read_rows(file, keep_rows);
  if (keep_rows > 0 && rows.text.compare(0, first.size(), first) != 0)
    throw common::DataError(file +
                            " has other columns than this version writes; go on with the version that "
                            "began it, or start again in another folder");
  if (!true_poses && rows.text.size() > rows.kept_bytes)
    set_aside(file, first, rows.text.substr(rows.kept_bytes));
  common::write_file_atomically(file, rows.kept_bytes > 0 ? rows.text.substr(0, rows.kept_bytes) : first);
  file_.open(file, std::ios::app);
  flush();
  file_ << std::setprecision(9);
}

void Recorder::write(const TrialPlan& plan, const std::string& rig, const std::string& controller,
                     const TrialSample& sample) {
  write_row(plan, rig, controller, sample);
  flush();
}

void Recorder::write(const TrialResult& result, std::size_t first_sample) {
  for (std::size_t i = first_sample; i < result.samples.size(); ++i)
    write_row(result.plan, result.rig, result.controller, result.samples[i]);
  flush();
}

void Recorder::sync() { common::sync_path(path_); }

void Recorder::write_row(const TrialPlan& plan, const std::string& rig, const std::string& controller,
                         const TrialSample& sample) {
  const control::StepRecord& step = sample.step;
  file_ << rig << ',' << controller << ',' << plan.task << ',' << plan.index << ',' << step.time_s << ',';
  if (true_poses_) write_pose(file_, sample.true_pose);
  file_ << (step.estimate.valid ? 1 : 0) << ',';
  write_pose(file_, step.estimate.valid ? std::optional(step.estimate.pose) : std::nullopt);
  file_ << step.target_m.x() << ',' << step.target_m.y() << ',' << (sample.approach ? 1 : 0);
  for (const double number : step.action) file_ << ',' << number;
  for (const double current_A : step.current_A) file_ << ',' << current_A;
  if (step.drive_gain)
    file_ << ',' << step.drive_gain->log_mean << ',' << step.drive_gain->log_sigma << ','
          << (step.rig_changed ? 1 : 0);
  else
    file_ << ",,,";
  file_ << ',' << (step.estimate.camera_moved ? 1 : 0) << '\n';
}

void Recorder::flush() {
  file_.flush();
  if (!file_) throw common::IoError("cannot write " + path_ + ": " + std::strerror(errno));
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
  }
  if (!plan.stitches.empty()) {
    record.stitches.emplace();
    for (const geometry::Stitch& stitch : plan.stitches)
      record.stitches->push_back({pose_mm(stitch.entry), pose_mm(stitch.exit)});
  }
  if (plan.moves()) {
    record.reference_mm.emplace();
    record.approach.emplace();
    const auto headed = [](const TrialSample& sample) { return sample.step.target_heading_rad.has_value(); };
    if (!result.samples.empty() && std::all_of(result.samples.begin(), result.samples.end(), headed))
      record.reference_heading_rad.emplace();
  } else {
    record.target_mm = point_mm(plan.target_m);
    if (plan.routes) record.route_mm.emplace();
  }
  if (!plan.obstacles.empty()) {
    record.obstacles_mm.emplace();
    for (const physics::ObstacleConfig& disc : plan.obstacles)
      record.obstacles_mm->push_back({geometry::kMmPerM * disc.centre_m[0],
                                      geometry::kMmPerM * disc.centre_m[1],
                                      geometry::kMmPerM * disc.radius_m});
    if (plan.routes) record.unreachable = plan.unreachable;
  }
  if (!result.told_zones.empty()) record.told_zones.emplace();
  for (const ToldZones& told : result.told_zones) {
    runs::ToldZonesRecord& since = record.told_zones->emplace_back();
    since.time_s = told.time_s;
    for (const geometry::Zone& zone : told.zones) {
      runs::ZoneRecord& written = since.zones.emplace_back();
      written.name = zone.called();
      written.radius_mm = geometry::kMmPerM * zone.radius_m;
      for (const geometry::Vector2& corner_m : zone.points_m())
        written.corners_mm.push_back(point_mm(corner_m));
    }
  }
  if (result.truth) record.trajectory.emplace();
  record.current_A.emplace();
  const bool temperatures = !result.samples.empty() && result.samples.back().temperature_C;
  if (temperatures) record.temperature_C.emplace();
  const auto identified = [](const TrialSample& sample) { return sample.step.drive_gain.has_value(); };
  if (std::any_of(result.samples.begin(), result.samples.end(), identified)) record.log_drive_gain.emplace();
  for (const TrialSample& sample : result.samples) {
    record.time_s.push_back(sample.step.time_s);
    if (record.trajectory) record.trajectory->push_back(pose_mm(*sample.true_pose));
    const control::PoseEstimate& estimate = sample.step.estimate;
    record.sensed_trajectory.push_back(estimate.valid ? std::optional(pose_mm(estimate.pose)) : std::nullopt);
    record.current_A->push_back(sample.step.current_A.list());
    if (sample.step.rig_changed && !record.rig_changed_s) record.rig_changed_s = sample.step.time_s;
    if (estimate.camera_moved && !record.camera_moved_s) record.camera_moved_s = sample.step.time_s;
    if (record.log_drive_gain) {
      const std::optional<task::DriveGain>& gain = sample.step.drive_gain;
      record.log_drive_gain->push_back(
          gain ? std::optional(std::array<double, 2>{gain->log_mean, gain->log_sigma}) : std::nullopt);
    }
    // Before the first pulse nothing has been reported.
    if (temperatures)
      record.temperature_C->push_back(sample.temperature_C ? std::optional(sample.temperature_C->list())
                                                           : std::nullopt);
    if (record.route_mm &&
        (record.route_mm->empty() || record.route_mm->back() != point_mm(sample.step.target_m)))
      record.route_mm->push_back(point_mm(sample.step.target_m));
    if (!plan.moves()) continue;
    record.reference_mm->push_back(point_mm(sample.step.target_m));
    if (record.reference_heading_rad)
      record.reference_heading_rad->push_back(*sample.step.target_heading_rad);
    record.approach->push_back(sample.approach ? 1 : 0);
  }
  return record;
}

}  // namespace lodestone::experiments
