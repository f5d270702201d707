#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/control/reference.h"
#include "lodestone/experiments/score.h"

using namespace lodestone;
using experiments::ScoredSample;
using geometry::Vector2;

TEST_CASE("a run to a point is scored by its end") {
  const Vector2 target(0.0, 0.0);
  const std::vector<ScoredSample> samples = {{0.0, {0.020, 0.0}, target, false},
                                             {0.3, {0.002, 0.0}, target, false},
                                             {0.6, {0.004, 0.0}, target, false},
                                             {0.9, {0.001, 0.0}, target, false}};
  const auto score = experiments::score_point(samples, {0.003, 5.0});
  CHECK(score.final_error_mm == Approx(1.0));
  CHECK(score.success);
  CHECK(*score.steps_to_reach == 1);
  CHECK(*score.seconds_to_reach == Approx(0.3));
  CHECK(*score.hold_error_mm == Approx(7.0 / 3.0));
  CHECK(*experiments::score_point(samples, {0.003, 0.3}).hold_error_mm == Approx(2.5));
  CHECK_FALSE(score.cross_track_rms_mm);
  const auto missed = experiments::score_point({samples[0]}, {0.003, 5.0});
  CHECK_FALSE(missed.success);
  CHECK_FALSE(missed.hold_error_mm);
  CHECK_FALSE(missed.steps_to_reach);
}

TEST_CASE("a run along a path has a cross-track and a timed error") {
  const geometry::Path path({{0.0, 0.0}, {0.1, 0.0}}, false);
  const std::vector<ScoredSample> samples = {{0.0, {0.0, 0.050}, {0.0, 0.0}, true},
                                             {0.3, {0.010, 0.003}, {0.014, 0.0}, false},
                                             {0.6, {0.020, -0.001}, {0.020, 0.0}, false}};
  const auto score = experiments::score_path(samples, path, {0.003, 5.0});
  REQUIRE(score.errors_mm.size() == 2);
  CHECK(*score.cross_track_rms_mm == Approx(std::sqrt((9.0 + 1.0) / 2.0)));
  CHECK(*score.time_rms_error_mm == Approx(std::sqrt((25.0 + 1.0) / 2.0)));
  CHECK(score.success);
  const auto never = experiments::score_path({samples[0]}, path, {0.1, 5.0});
  CHECK_FALSE(never.success);
  CHECK(never.errors_mm.size() == 1);
}

TEST_CASE("errors of all trials are pooled, and summed up as known numbers are") {
  const auto summed_up = [](std::vector<double> errors_mm) {
    runs::TrialFigures first;
    first.errors_mm = {errors_mm.back()};
    errors_mm.pop_back();
    runs::TrialFigures others;
    others.errors_mm = errors_mm;
    return experiments::summarise_trials({&others, &first});
  };
  const auto summary = summed_up({4.0, 1.0, 2.0, 3.0});
  CHECK(summary.mean_error_mm == Approx(2.5));
  CHECK(summary.median_error_mm == Approx(2.5));
  CHECK(summary.std_error_mm == Approx(std::sqrt(5.0 / 3.0)));
  CHECK(summary.rms_error_mm == Approx(std::sqrt(7.5)));
  CHECK(summed_up({3.0, 1.0, 2.0}).median_error_mm == 2.0);
}

TEST_CASE("a task is summed up by true poses where they are known, and by what was seen") {
  runs::TrialRecord good;
  good.completed = true;
  good.truth.emplace().errors_mm = {1.0};
  good.truth->success = true;
  good.truth->steps_to_reach = 4;
  good.sensed.errors_mm = {2.0};
  runs::TrialRecord bad;
  bad.truth.emplace().errors_mm = {5.0};
  bad.truth->heading_error_deg = 5.5;
  bad.sensed.errors_mm = {6.0};
  runs::TaskSummary summary = experiments::summarise_task({good, bad});
  REQUIRE(summary.truth);
  CHECK(summary.truth->mean_error_mm == Approx(3.0));
  CHECK(summary.truth->success_rate == Approx(0.5));
  CHECK(summary.truth->steps_to_reach == 4.0);
  CHECK(summary.truth->heading_error_deg == 5.5);
  CHECK_FALSE(summary.truth->hold_error_mm);
  CHECK(summary.sensed.mean_error_mm == Approx(4.0));
  CHECK(summary.n_trials == 2);
  CHECK(summary.n_stopped == 1);
  good.truth.reset();
  bad.truth.reset();
  summary = experiments::summarise_task({good, bad});
  CHECK_FALSE(summary.truth);
  CHECK(summary.sensed.mean_error_mm == Approx(4.0));
}

TEST_CASE("the reference waits at the start of a path and then moves at its speed") {
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  config.approach_limit_s = 5.0;
  control::PathReference reference(geometry::Path({{0.0, 0.0}, {0.1, 0.0}}, false), config);
  CHECK(reference.target(0.0, {0.03, 0.0}).x() == 0.0);
  CHECK(reference.approaching());
  CHECK(reference.target(1.0, {0.002, 0.0}).x() == 0.0);
  CHECK_FALSE(reference.approaching());
  CHECK(reference.target(2.0, {0.03, 0.0}).x() == Approx(0.01));
  CHECK_FALSE(reference.finished(10.9));
  CHECK(reference.finished(11.0));
  reference.reset();
  CHECK(reference.target(4.9, {0.03, 0.0}).x() == 0.0);
  CHECK(reference.target(5.0, {0.03, 0.0}).x() == 0.0);
  CHECK(reference.target(6.0, {0.03, 0.0}).x() == Approx(0.01));
  control::PathReference laps(geometry::Path::square(0.03), {0.002, 0.003, 20.0, 2});
  CHECK(laps.duration_s() == Approx(120.0));
}
