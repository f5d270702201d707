#include "lodestone/experiments/effort.h"

#include <catch2/catch.hpp>

using namespace lodestone;

namespace {

/// Two pulses, the second of two coils, and a last look without one.
experiments::TrialResult two_pulses() {
  experiments::TrialResult result;
  for (int i = 0; i < 3; ++i) {
    experiments::TrialSample sample;
    sample.step.time_s = 0.3 * i;
    sample.step.current_A = {0.0, 0.0, 0.0, 0.0};
    result.samples.push_back(sample);
  }
  result.samples[0].step.current_A = {10.0, 0.0, 0.0, 0.0};
  result.samples[1].step.current_A = {0.0, -5.0, 2.0, 0.0};
  return result;
}

}  // namespace

TEST_CASE("what a trial took is the time, the charge and the heat of its pulses") {
  control::ControlLoopConfig loop;
  loop.pulse_s = 0.1;
  physics::RigDescription rig;
  rig.coils.resistance_20C_ohm = {2.0, 1.0, 1.0, 1.0};
  experiments::TrialResult result = two_pulses();
  experiments::note_effort(loop, rig, result);
  CHECK(*result.sensed.duration_s == Approx(0.6));
  CHECK(*result.sensed.charge_As == Approx(1.7));
  CHECK(*result.sensed.heat_J == Approx(0.1 * (200.0 + 25.0 + 4.0)));
  CHECK_FALSE(result.truth);
  result.truth.emplace();
  experiments::note_effort(loop, rig, result);
  CHECK(*result.truth->charge_As == Approx(1.7));
}

TEST_CASE("what trials took is summed up as a mean over those that tell") {
  control::ControlLoopConfig loop;
  experiments::TrialResult once = two_pulses();
  experiments::note_effort(loop, {}, once);
  experiments::TrialResult twice = two_pulses();
  loop.pulse_s *= 2.0;
  experiments::note_effort(loop, {}, twice);
  const runs::TrialFigures older;
  const auto summary = experiments::summarise_trials({&once.sensed, &twice.sensed, &older});
  CHECK(*summary.charge_As == Approx(1.5 * *once.sensed.charge_As));
  CHECK(*summary.heat_J == Approx(1.5 * *once.sensed.heat_J));
  CHECK(*summary.duration_s == Approx(0.6));
}
