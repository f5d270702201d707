#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/experiments/guided_needle.h"
#include "lodestone/experiments/stick_slip.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/qualification_result.h"
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
  }
  void validate() const { rig.validate(); }
};

/// The virtual bench of a qualification.
std::unique_ptr<session::RigSession> make_qualification_session(const QualificationConfig& config);

/// Measures what a bench can do, item by item, each within its share of the time: how far looks at a still
/// needle differ, the coils' currents, the same pulse from like starts, the time from command to motion, what
/// weak pulses do at several places, where looks give no pose; at the end the pulse and the still needle
/// again. An item that has begun a pulse or a way ends it.
class Qualification {
 public:
  /// Told how much of the time has passed (s, of the bench) and what is measured.
  using Watch = std::function<void(double passed_s, const std::string& item)>;

  /// Both must outlive it. The needle lies in the dish, anywhere.
  Qualification(const QualificationConfig& config, session::RigSession& bench, Watch watch = {});

  /// Runs to the end, or to where it is stopped (result.stopped): by a signal, the supervisor, or a needle
  /// that is lost. The coils are off then. What was measured is in the result either way, with verdicts.
  runs::QualificationResult run();

 private:
  void measure();
  /// Whether there is time left for an item, which ends at this share of all; tells the watch.
  bool time_for(const std::string& item, double share);
  void lie_still(const std::string& item, double share, std::optional<runs::StillFigures>& figures);
  void measure_coils(double share);
  void measure_coil(std::size_t coil);
  void repeat_pulse(const std::string& item, std::vector<PulseMotion>& pulses, double share);
  void measure_latency(double share);
  /// One pulse after a part of a look's time: whether its motion was seen.
  bool time_motion(double part);
  void push_weakly(double share);
  /// Ever stronger pulses about a place, until all move the needle far.
  void climb(std::size_t place, const geometry::Vector2& at_m, double share);
  void roam(double share);
  /// Back to the middle of the dish, where the needle has come far from it.
  void keep_inside();
  double test_current_of(std::size_t coil) const;
  void note_temperatures(std::vector<double>& temperatures_C);
  /// Figures of what there is.
  void close();

  const QualificationConfig& config_;
  session::RigSession& bench_;
  Watch watch_;
  GuidedNeedle needle_;
  control::DipolePull pull_;
  MotionThreshold threshold_;
  double start_s_;
  std::vector<std::vector<CurrentRise>> rises_;
  std::int64_t reports_ = 0;  ///< of a current while its coil was on
  std::vector<PulseMotion> early_, late_;
  std::vector<double> moved_s_, gaps_s_;  ///< of motion after pulses, and between looks
  std::int64_t unseen_ = 0;
  std::vector<WeakPulse> weak_;
  std::vector<double> first_C_, last_C_;
  runs::QualificationResult result_;
};

}  // namespace lodestone::experiments
