#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/control/pose_sensor.h"
#include "lodestone/geometry/keep_out.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/camera_model.h"
#include "lodestone/physics/per_coil.h"
#include "lodestone/rig/coils.h"

namespace lodestone::console {

enum class Mode { kDisconnected, kDisarmed, kArmed, kRunning, kStopped };
inline std::vector<std::string> names_of(Mode) {
  return {"disconnected", "disarmed", "armed", "running", "stopped"};
}

/// Instruments at one step of the control loop, or at one look in between. What is not known is absent.
struct BenchSample {
  double time_s = 0.0;  ///< on the bench's clock
  std::optional<double> error_mm;
  physics::PerCoil current_A;  ///< as asked
  physics::PerCoil duty;       ///< fraction of the last ten seconds that it was on
  std::optional<physics::PerCoil> temperature_C;
  std::optional<double> supply_V;
  std::optional<double> pose_age_ms;
  std::optional<double> jitter_ms;  ///< of the time between this pulse and the one before
  std::optional<geometry::Pose2> pose;
  std::optional<geometry::Vector2> target_m;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("time_s", time_s);
    v.field("error_mm", error_mm);
    v.field("current_A", current_A);
    v.field("duty", duty);
    v.field("temperature_C", temperature_C);
    v.field("supply_V", supply_V);
    v.field("pose_age_ms", pose_age_ms);
    v.field("jitter_ms", jitter_ms);
  }
};

/// A run that is under way.
struct BenchRun {
  std::string task;
  double time_s = 0.0;
  std::int64_t steps = 0;
  double aimed_s = 0.0;               ///< when it was given the goal that it has now
  std::optional<double> left_s = {};  ///< where it has an end
};

/// What a bench shows of itself at one moment.
struct BenchState {
  Mode mode = Mode::kDisconnected;
  std::string reason;   ///< why it is disconnected or stopped
  std::string why_not;  ///< what still keeps it from taking pulses again; empty: nothing
  bool clears = false;  ///< taking pulses again clears faults that the coil controller has latched
  double now_s = 0.0;
  std::string controller;
  bool unattended = false;
  bool attended = false;  ///< what runs ends when the operator's page does
  std::optional<BenchRun> run;
  std::optional<control::PoseEstimate> pose;  ///< as seen last
  std::optional<geometry::Vector2> target_m;
  std::optional<double> target_heading_rad;
  std::vector<geometry::Vector2> plan_m;   ///< the path that is shown or followed
  std::vector<geometry::Vector2> trail_m;  ///< where the needle was, oldest first
  physics::PerCoil on_A;                   ///< what the coils have been asked for and still hold
  /// How the needle shall lie along that path, where it has headings, at some places.
  std::vector<geometry::Pose2> plan_headings;
  geometry::KeepOut keep_out;  ///< what the needle must keep out of, as far as is known
  std::optional<imaging::CameraModel> camera;
  std::optional<BenchSample> sample;  ///< the last one,
  std::int64_t samples = 0;           ///< of so many
};

}  // namespace lodestone::console
