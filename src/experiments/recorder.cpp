#include "lodestone/experiments/recorder.h"

#include <iomanip>
#include <optional>

#include "lodestone/common/error.h"

namespace lodestone::experiments {

namespace {

constexpr double kMmPerM = 1000.0;
constexpr double kDegPerRad = 180.0 / 3.14159265358979323846;

common::Json pose_mm(const geometry::Pose2& pose) {
  return {kMmPerM * pose.x_m, kMmPerM * pose.y_m, pose.heading_rad};
}

common::Json point_mm(const geometry::Vector2& point_m) {
  return {kMmPerM * point_m.x(), kMmPerM * point_m.y()};
}

template <class Value>
common::Json maybe(const std::optional<Value>& value, double scale = 1.0) {
  if (!value) return nullptr;
  return scale * static_cast<double>(*value);
}

common::Json score_to_json(const TrialScore& score) {
  common::Json json;
  json["final_error_mm"] = kMmPerM * score.final_error_m;
  json["success"] = score.success;
  json["hold_error_mm"] = maybe(score.hold_error_m, kMmPerM);
  json["heading_error_deg"] = maybe(score.heading_error_rad, kDegPerRad);
  json["cross_track_rms_mm"] = maybe(score.cross_track_rms_m, kMmPerM);
  json["time_rms_error_mm"] = maybe(score.time_rms_m, kMmPerM);
  json["steps_to_reach"] = maybe(score.steps_to_reach);
  json["seconds_to_reach"] = maybe(score.seconds_to_reach);
  return json;
}

}  // namespace

Recorder::Recorder(const std::string& file) : path_(file), file_(file, std::ios::trunc) {
  file_ << "rig,controller,task,trial,t_s,true_x_m,true_y_m,true_heading_rad,sensed,sensed_x_m,sensed_y_m,"
           "sensed_heading_rad,target_x_m,target_y_m,approach,action_x,action_y,current_px_A,current_mx_A,"
           "current_py_A,current_my_A\n";
  file_.flush();
  if (!file_) throw common::IoError("cannot write " + path_ + ": check the folder and the space on the disk");
  file_ << std::setprecision(9);
}

void Recorder::write(const TrialResult& result) {
  for (const TrialSample& sample : result.samples) {
    const control::StepRecord& step = sample.step;
    file_ << result.rig << ',' << result.controller << ',' << result.plan.task << ',' << result.plan.index
          << ',' << step.time_s << ',' << sample.true_pose.x_m << ',' << sample.true_pose.y_m << ','
          << sample.true_pose.heading_rad << ',' << (step.estimate.valid ? 1 : 0) << ',';
    if (step.estimate.valid)
      file_ << step.estimate.pose.x_m << ',' << step.estimate.pose.y_m << ','
            << step.estimate.pose.heading_rad;
    else
      file_ << ",,";
    file_ << ',' << step.target_m.x() << ',' << step.target_m.y() << ',' << (sample.approach ? 1 : 0) << ','
          << step.action.x() << ',' << step.action.y();
    for (const double current_A : step.current_A) file_ << ',' << current_A;
    file_ << '\n';
  }
  file_.flush();
  if (!file_) throw common::IoError("cannot write " + path_ + ": check the space on the disk");
}

common::Json trial_to_json(const TrialResult& result) {
  common::Json json;
  json["task"] = result.plan.task;
  json["rig"] = result.rig;
  json["controller"] = result.controller;
  json["trial"] = result.plan.index;
  json["start"] = pose_mm(result.plan.start);
  if (result.plan.path) {
    common::Json points = common::Json::array();
    for (const geometry::Vector2& point_m : result.plan.path->points_m()) points.push_back(point_mm(point_m));
    json["path_mm"] = points;
  } else {
    json["target_mm"] = point_mm(result.plan.target_m);
    if (result.plan.target_heading_rad) json["target_heading_rad"] = *result.plan.target_heading_rad;
  }
  common::Json trajectory = common::Json::array();
  common::Json sensed = common::Json::array();
  common::Json reference = common::Json::array();
  common::Json approach = common::Json::array();
  for (const TrialSample& sample : result.samples) {
    trajectory.push_back(pose_mm(sample.true_pose));
    sensed.push_back(sample.step.estimate.valid ? pose_mm(sample.step.estimate.pose) : common::Json(nullptr));
    if (!result.plan.path) continue;
    reference.push_back(point_mm(sample.step.target_m));
    approach.push_back(sample.approach ? 1 : 0);
  }
  json["trajectory"] = trajectory;
  json["sensed_trajectory"] = sensed;
  if (result.plan.path) {
    json["reference_mm"] = reference;
    json["approach"] = approach;
  }
  json.update(score_to_json(result.truth));
  json["sensed"] = score_to_json(result.sensed);
  json["completed"] = result.completed;
  json["stop_reason"] = result.stop_reason;
  return json;
}

}  // namespace lodestone::experiments
