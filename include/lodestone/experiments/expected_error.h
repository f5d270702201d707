#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lodestone/experiments/stick_slip.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

// Not told by `qualify` yet. On six virtual rigs (lab and wide, seeds 21 to 23) it said 1.3 mm and far more,
// where the planner was measured at 0.24 to 0.29 mm RMS: weak pulses that scatter more than they move leave
// no step that brings the needle closer, and trials run away.
//
// The error to expect at points: where a needle comes to rest under a controller that knows what pulses do
// on average, and nothing else. Everything it is made of has been measured on the bench; this file and its
// source are the only place where it is put together.
//
// The needle is at t from its target, and is sensed at t + e, where e is normal with `sensing` (s) per axis;
// a needle that lies still errs as before, one that has moved errs anew. The controller asks for a step of
//
//   d = max(|t + e|, smallest step)
//
// straight at the target, as nothing shorter moves the needle reliably. It gets that step and a scatter,
// which is normal, per axis with
//
//   sigma(d) = sqrt(floor^2 + (growth d)^2).
//
// The next place as it will be sensed is thus normal about the overshoot d - |t + e|, per axis with
//
//   S(d)^2 = sigma(d)^2 + 2 s^2
//
// (what it aims by errs, and what it will see). A controller that looks one pulse ahead leaves the needle
// where it is once that would bring it no closer: at a sensed distance r with
//
//   r^2 = (d - r)^2 + (pi / 2) S(d)^2
//
// (of a normal in the plane about 0 the mean length is S sqrt(pi / 2); an overshoot adds as a square). Hence
//
//   r = d / 2 + (pi / 4) S(d)^2 / d
//
// where that is no more than the smallest step d, and otherwise, with d = r,
//
//   r^2 = (pi / 2) (floor^2 + 2 s^2) / (1 - (pi / 2) growth^2).
//
// With a growth of sqrt(2 / pi) = 0.80 or more no step brings the needle closer than it was; from 0.76 on r
// is taken to be 5 mm.
//
// So the needle comes to rest where a step happens to end within r. Without an overshoot that is a Rayleigh
// distribution cut at r = sqrt(pi / 2) S, whose RMS is 0.83 S. Trials are played by that rule, with looks
// that may give no pose, and end after so many pulses: RMS and 95th percentile of |t|.
//
// What is left out makes real trials worse (places where no coil pulls well; a needle that cannot be moved in
// every direction from every heading; a localiser that is off as a whole, which nothing on the bench shows)
// or better (a controller that plans several pulses, and learns the place it is at). ErrorModel has one
// number for each, 1 as derived: they are what to calibrate, on rigs whose seeds are for tuning and never on
// those that are reported.

/// Factors by which controllers differ from the derivation.
struct ErrorModel {
  double patience = 1.0;  ///< on the distance at which the needle is left where it is
  double aim = 1.0;       ///< on the scatter of steps
};

/// What the error is made of, mm, per axis where it is a spread.
struct ErrorSources {
  double sensing_mm = 0.0;
  StepLaw steps;
  double refused = 0.0;      ///< share of looks without a pose
  std::int64_t pulses = 66;  ///< of a trial
};

struct PointErrors {
  double rms_mm = 0.0;
  double p95_mm = 0.0;
  double rest_mm = 0.0;  ///< r
};

/// How close is close enough: r above.
double rest_distance_mm(const ErrorSources& sources, const ErrorModel& model = {});
/// Plays trials. The same sources always give the same errors.
PointErrors point_errors(const ErrorSources& sources, const ErrorModel& model = {});

/// By weak pulses and the sensor, with intervals: pulses of each level drawn anew. `trial_pulses`: how many a
/// trial has. Nothing where no weak pulse moves the needle often enough.
std::optional<runs::ExpectedErrorFigures> expected_error(const std::vector<WeakPulse>& pulses,
                                                         double sensing_m, double refused,
                                                         std::int64_t trial_pulses);

}  // namespace lodestone::experiments
