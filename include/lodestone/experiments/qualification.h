#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/control/dipole_pull.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/experiments/guided_needle.h"
#include "lodestone/experiments/points_config.h"
#include "lodestone/experiments/qualification_state.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/qualification_result.h"
#include "lodestone/runs/resumable_run.h"
#include "lodestone/safety/supervisor.h"
#include "lodestone/session/rig_session.h"
#include "lodestone/session/sensing.h"

namespace lodestone::experiments {

/// What `qualify` measures with.
struct QualificationConfig {
  std::int64_t seed = 1;
  std::int64_t rig_seed = 1;
  std::int64_t sensor_seed = 1;
  std::int64_t threads = 1;
  double minutes = 15.0;
  double test_current_A = 3.0;
  GuidedNeedleConfig needle;
  safety::SafetyConfig safety;
  rig::RigConfig rig;
  session::SensingConfig sensor;
  PointsConfig points;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the places that are visited, and of the sensor's noise", {0, 9e15});
    v.field("rig_seed", rig_seed, "", "seed of what is hidden in a virtual rig, as in collect", {0, 9e15});
    v.field("sensor_seed", sensor_seed, "", "seed of a virtual rig's camera, as in collect", {0, 9e15});
    v.field("threads", threads, "", "not used: there is one needle", {0, 1024});
    v.field("minutes", minutes, "min", "of the bench, at most", {0.1, 1440.0});
    v.field("test_current_A", test_current_A, "A", "of the pulses that coils and latency are measured by",
            {0.1, 20.0});
    needle.visit(v);
    v.group("safety", safety, "limits of the supervisor");
    v.group("rig", rig, "the rig");
    v.group("sensor", sensor, "how poses are sensed");
    v.group("points", points, "the short deployment at the end, which tells the error to expect");
  }
  /// Throws ConfigError, also where there are zones to keep out of: it drives all over the dish.
  void validate() const;

  /// What the points are driven as: `deploy --task point`, on this rig.
  DeployConfig deploy() const;
};

/// What drives to points. Throws as plan_job does.
ControllerSource points_source(const QualificationConfig& config);

/// The virtual bench of a qualification.
std::unique_ptr<session::RigSession> make_qualification_session(const QualificationConfig& config);

/// Measures what a bench can do, item by item, each within its share of the time: how far looks at a still
/// needle differ, the coils' currents, the same pulse from like starts, the time from command to motion, what
/// weak pulses do at several places, where looks give no pose; then the pulse and the still needle again, and
/// at last how near to points a short deployment comes. It is resumable work, whose steps are pieces: a
/// needle that lies still (in one piece, as a drift over a gap would be none), one pulse, a level of weak
/// pulses, a place, a trial. Every piece of a bench counts once it is saved; what a step left half-done when
/// it was stopped does not. A virtual bench goes on from where its item began, bitwise as if never stopped.
class Qualification : public runs::ResumableWork {
 public:
  /// `config` and `bench` must outlive it. The needle lies in the dish, anywhere. `driver`: points_source().
  Qualification(const QualificationConfig& config, session::RigSession& bench, ControllerSource driver);

  /// Seconds of the bench, and the item that is next. Finished, too, where it was stopped (result().stopped)
  /// by a signal, the supervisor, or a needle that is lost; the coils are off then.
  runs::Progress progress() const override;
  void step(common::MetricsLog& metrics) override;
  /// Throws IoError.
  void save(const std::string& folder) override;
  /// Where nothing was saved, nothing is loaded. Throws DataError.
  void load(const std::string& folder) override;

  /// What was measured until now, with verdicts.
  runs::QualificationResult result() const;

 private:
  struct Item {
    const char* name;
    double until;  ///< this share of the time it may go on: of what the points leave, and they of all
    bool (Qualification::*measure)();  ///< one more piece; false where there is none left
  };
  static const std::vector<Item>& items();

  double passed_s() const;
  bool ended() const;
  /// Whether so much is left of the item's time.
  bool time_left(double needed_s = 0.0) const;
  double point_s() const;
  double points_s() const;
  void begin_item();
  void end_item();
  void measure_piece();
  /// What is there now is what goes on.
  void keep();
  void note_gap();

  bool lie_still_at_first();
  bool lie_still_at_end();
  std::optional<runs::StillFigures> lie_still();
  bool measure_coils();
  void measure_coil(std::size_t coil);
  bool repeat_pulse_at_first();
  bool repeat_pulse_at_end();
  bool repeat_pulse(std::vector<PulseMotion>& pulses);
  bool measure_latency();
  /// One pulse after a part of a look's time: whether its motion was seen.
  bool time_motion(double part);
  /// Ever stronger pulses about a place, level by level, until all move the needle far.
  bool push_weakly();
  /// Pulses of one level: whether all moved the needle far.
  bool push_level(const geometry::Vector2& at_m, double current_A);
  double weak_current_A(const geometry::Vector2& at_m) const;
  bool roam();
  /// One trial, from where the needle lies.
  bool drive_to_point();
  /// Back to the middle of the dish, where the needle has come far from it.
  void keep_inside();
  double largest_A() const;
  double test_current_of(std::size_t coil) const;
  std::vector<double> temperatures_C();
  std::vector<runs::CoilFigures> measured_coils() const;

  const QualificationConfig& config_;
  session::RigSession& bench_;
  DeploymentConfig deployment_;  ///< of the points
  ControllerSource driver_;
  GuidedNeedle needle_;
  control::DipolePull pull_;
  MotionThreshold threshold_;
  double start_s_;
  QualificationState state_;
  std::optional<QualificationState> unsaved_;  ///< where it can go on, when that is not on the disk yet
  bool begun_ = false;                         ///< the item, by this process
  bool at_place_ = false;                      ///< of weak pulses
  std::optional<std::string> stopped_;
};

}  // namespace lodestone::experiments
