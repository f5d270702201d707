#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "lodestone/common/error.h"
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

namespace {

constexpr double kSpeed_m_s = 0.002;
constexpr double kPeriod_s = 0.3;

/// A run along the square of 30 mm with the needle where `needle_m` says that it is at a time, after an
/// approach that counts for nothing.
runs::TrialFigures along_the_square(const std::function<Vector2(double)>& needle_m) {
  const geometry::Path square = geometry::Path::square(0.03);
  std::vector<ScoredSample> samples = {{-kPeriod_s, {0.0, 0.0}, square.at(0.0), true}};
  for (int step = 0; step <= 200; ++step) {
    const double time_s = kPeriod_s * step;
    samples.push_back({time_s, needle_m(time_s), square.at(kSpeed_m_s * time_s), false});
  }
  return experiments::score_path(samples, square, {});
}

/// The largest share of points by every way of choosing moments, for short runs.
double completion_by_trying(const std::vector<ScoredSample>& samples,
                            const experiments::ScoreConfig& config) {
  const std::function<int(std::size_t, std::size_t)> most = [&](std::size_t point, std::size_t from) -> int {
    if (point == samples.size()) return 0;
    int best = most(point + 1, from);
    for (std::size_t i = from; i < samples.size(); ++i)
      if (std::abs(samples[i].time_s - samples[point].time_s) <= config.completion_window_s &&
          (samples[i].position_m - samples[point].target_m).norm() <= config.success_radius_m)
        best = std::max(best, 1 + most(point + 1, i));
    return best;
  };
  return most(0, 0) / static_cast<double>(samples.size());
}

}  // namespace

TEST_CASE("a needle that follows a path comes to all of it") {
  const geometry::Path square = geometry::Path::square(0.03);
  const auto late = along_the_square([&](double time_s) { return square.at(kSpeed_m_s * (time_s - 1.0)); });
  CHECK(late.success);
  CHECK(*late.completion == 1.0);
  CHECK(*late.corners_reached == 1.0);
  CHECK(late.corner_errors_mm->size() == 4);
  CHECK(*late.cross_track_rms_mm < 0.01);
  CHECK(*late.time_rms_error_mm == Approx(2.0).margin(0.05));
  CHECK(*late.target_deviation_mm == Approx(2.0).margin(0.05));
  CHECK(*late.frechet_mm < 3.0);
  CHECK(late.final_error_mm == Approx(2.0));
}

TEST_CASE("a needle that lies on the path has not followed it") {
  const geometry::Path square = geometry::Path::square(0.03);
  const auto still = along_the_square([&](double) { return square.at(0.0); });
  CHECK(*still.cross_track_rms_mm < 0.01);
  CHECK_FALSE(still.success);
  CHECK(*still.completion < 0.1);
  CHECK(*still.corners_reached == 0.25);
  CHECK(*still.frechet_mm == Approx(1e3 * 0.03 * std::sqrt(2.0)).epsilon(0.01));
}

TEST_CASE("one that stops on its way has followed it so far") {
  const geometry::Path square = geometry::Path::square(0.03);
  const auto stopped =
      along_the_square([&](double time_s) { return square.at(kSpeed_m_s * std::min(time_s, 30.0)); });
  CHECK_FALSE(stopped.success);
  CHECK(*stopped.cross_track_rms_mm < 0.01);
  CHECK(*stopped.completion == Approx(0.5 + 0.025).margin(0.01));  // and what lies within the radius ahead
  CHECK(*stopped.corners_reached == 0.75);
  CHECK(*stopped.time_rms_error_mm > 15.0);
}

TEST_CASE("one that runs ahead, or comes late, or goes backwards is where it should be at the wrong time") {
  const geometry::Path square = geometry::Path::square(0.03);
  const auto ahead =
      along_the_square([&](double time_s) { return square.at(0.004 * std::min(time_s, 30.0)); });
  CHECK_FALSE(ahead.success);
  CHECK(*ahead.corners_reached == 1.0);
  CHECK(*ahead.completion < 0.3);
  const auto late =
      along_the_square([&](double time_s) { return square.at(kSpeed_m_s * std::max(0.0, time_s - 6.0)); });
  CHECK_FALSE(late.success);
  CHECK(*late.completion < 0.2);
  const auto backwards = along_the_square([&](double time_s) { return square.at(-kSpeed_m_s * time_s); });
  CHECK_FALSE(backwards.success);
  CHECK(*backwards.cross_track_rms_mm < 0.01);
  CHECK(*backwards.corners_reached == 1.0);
  CHECK(*backwards.completion < 0.2);
}

TEST_CASE("one that cuts a corner has not been there") {
  const geometry::Path square = geometry::Path::square(0.03);
  const Vector2 cut(0.015, 0.015);
  const auto needle = [&](double time_s) {
    const Vector2 at = square.at(kSpeed_m_s * time_s);
    const double short_of_m = 0.006 - (at - cut).lpNorm<1>();
    return short_of_m > 0.0 ? Vector2(at - short_of_m * Vector2(0.5, 0.5)) : at;
  };
  const auto score = along_the_square(needle);
  CHECK(*score.cross_track_rms_mm < 3.0);
  CHECK(*score.corners_reached == 0.75);
  CHECK(score.corner_errors_mm->at(1) > 3.0);
  CHECK_FALSE(score.success);
}

TEST_CASE("one that skips a side loses what it skipped") {
  const geometry::Path square = geometry::Path::square(0.03);
  const auto score = along_the_square([&](double time_s) {  // waits at a corner for the second side's 15 s
    const bool skipping = time_s > 15.0 && time_s < 30.0;
    return square.at(kSpeed_m_s * (skipping ? 15.0 : time_s));
  });
  CHECK_FALSE(score.success);
  CHECK(*score.corners_reached == 1.0);
  CHECK(*score.completion == Approx(0.75 + 0.05).margin(0.03));
}

TEST_CASE("completion is the best of all ways of choosing moments") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(0.0, 0.01);
  experiments::ScoreConfig config;
  config.completion_window_s = 0.6;
  for (int round = 0; round < 200; ++round) {
    std::vector<ScoredSample> samples;
    for (int i = 0; i < 7; ++i)
      samples.push_back({kPeriod_s * i, {coordinate(random), 0.0}, {coordinate(random), 0.0}, false});
    config.completion_window_s = 0.61;
    CHECK(experiments::completion(samples, config) == Approx(completion_by_trying(samples, config)));
  }
}

TEST_CASE("a circle has no corners to be reached, and a path needs more than its approach") {
  const geometry::Path circle = geometry::Path::circle(0.015);
  const std::vector<ScoredSample> samples = {{0.0, circle.at(0.0), circle.at(0.0), false}};
  const auto score = experiments::score_path(samples, circle, {});
  CHECK_FALSE(score.corners_reached);
  CHECK(score.success);
  CHECK_THROWS_AS(experiments::score_path({{0.0, circle.at(0.0), circle.at(0.0), true}}, circle, {}),
                  common::LogicFault);
}

TEST_CASE("where a path has headings, the needle's counts moment by moment, after the approach") {
  const geometry::Path square = geometry::Path::square(0.03).with_heading(geometry::PathHeading::tangent());
  const auto lying = [&](const std::function<double(int)>& off_rad) {
    std::vector<ScoredSample> samples = {{-kPeriod_s, {0.0, 0.0}, square.at(0.0), true, 3.0, 0.0}};
    for (int step = 0; step <= 200; ++step) {
      const double arc_m = kSpeed_m_s * kPeriod_s * step;
      const std::optional<double> wanted_rad = square.heading_rad(arc_m);
      samples.push_back({kPeriod_s * step, square.at(arc_m), square.at(arc_m), false,
                         *wanted_rad + off_rad(step), wanted_rad});
    }
    return experiments::score_path(samples, square, {});
  };
  const auto exact = lying([](int) { return 2.0 * geometry::kPi; });
  REQUIRE(exact.heading_rms_deg);
  CHECK(*exact.heading_rms_deg == Approx(0.0).margin(1e-6));
  CHECK(exact.success);
  const auto swaying = lying([](int step) { return (step % 2 == 0 ? 10.0 : -10.0) * geometry::kRadPerDeg; });
  CHECK(*swaying.heading_rms_deg == Approx(10.0));
  CHECK(swaying.success);
  const auto half = lying([](int step) { return step > 100 ? 20.0 * geometry::kRadPerDeg : 0.0; });
  CHECK(*half.heading_rms_deg == Approx(20.0 * std::sqrt(100.0 / 201.0)));
  const auto askew = lying([](int) { return 20.0 * geometry::kRadPerDeg; });
  CHECK(*askew.heading_rms_deg == Approx(20.0));
  CHECK_FALSE(askew.success);
  CHECK(*askew.completion == 1.0);
  CHECK_FALSE(along_the_square([&](double) { return square.at(0.0); }).heading_rms_deg);
}

TEST_CASE("every trial counts the same, and they are summed up as known numbers are") {
  const auto summed_up = [](const std::vector<double>& errors_mm) {
    std::vector<runs::TrialFigures> trials(errors_mm.size());
    std::vector<const runs::TrialFigures*> pointers;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      trials[i].cross_track_rms_mm = errors_mm[i];
      trials[i].completion = 0.1 * errors_mm[i];
      if (i > 0) trials[i].heading_rms_deg = 2.0 * errors_mm[i];
      pointers.push_back(&trials[i]);
    }
    return experiments::summarise_trials(pointers);
  };
  const auto summary = summed_up({4.0, 1.0, 2.0, 3.0});
  CHECK(summary.mean_error_mm == Approx(2.5));
  CHECK(summary.median_error_mm == Approx(2.5));
  CHECK(summary.std_error_mm == Approx(std::sqrt(5.0 / 3.0)));
  CHECK(summary.rms_error_mm == Approx(std::sqrt(7.5)));
  CHECK(*summary.completion == Approx(0.25));
  CHECK(*summary.heading_rms_deg == Approx(4.0));  // of those that have it
  CHECK_FALSE(summary.corners_reached);
  CHECK(summed_up({3.0, 1.0, 2.0}).median_error_mm == 2.0);
}

TEST_CASE("a trial that touches a zone has failed, and its touches are counted one by one") {
  const geometry::KeepOut keep_out{{{"disc", {0.02, 0.0}, 0.004}}, 0.02, 0.001, 0.001};
  const auto scored = [&keep_out](const std::vector<geometry::Pose2>& poses) {
    runs::TrialFigures figures;
    figures.success = true;
    std::vector<double> clearances_m;
    for (const geometry::Pose2& pose : poses) clearances_m.push_back(keep_out.clearance_m(pose));
    experiments::score_keep_out(clearances_m, figures);
    return figures;
  };
  const auto clear = scored({{-0.02, 0.0, 0.0}, {0.0, 0.0, 0.0}, {-0.01, 0.0, 0.0}});
  CHECK(*clear.clearance_mm == Approx(5.5));
  CHECK(*clear.touches == 0);
  CHECK(clear.success);
  const auto touching = scored({{0.006, 0.0, 0.0}, {0.007, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.006, 0.0, 0.0}});
  CHECK(*touching.touches == 2);  // it came, stayed, went, and came again
  CHECK(*touching.clearance_mm == Approx(-1.5));
  CHECK_FALSE(touching.success);
  CHECK_FALSE(scored({}).clearance_mm);
  runs::TrialFigures without;
  without.success = true;
  experiments::score_keep_out({geometry::KeepOut{}.clearance_m({0.006, 0.0, 0.0})}, without);
  CHECK_FALSE(without.touches);
  CHECK(without.success);

  const auto summary = experiments::summarise_trials({&clear, &touching, &without});
  CHECK(*summary.clearance_mm == Approx(2.0));
  CHECK(*summary.least_clearance_mm == Approx(-1.5));
  CHECK(*summary.touches == Approx(1.0));
  CHECK(*summary.touching_rate == Approx(0.5));  // of the two that had zones
  CHECK(summary.touching_interval->at(0) == Approx(0.094).margin(0.01));
  CHECK(summary.touching_interval->at(1) == Approx(0.906).margin(0.01));
  CHECK_FALSE(experiments::summarise_trials({&without}).touching_rate);
}

TEST_CASE("a task is summed up by true poses where they are known, and by what was seen") {
  runs::TrialRecord good;
  good.completed = true;
  good.truth.emplace().final_error_mm = 1.0;
  good.truth->success = true;
  good.truth->steps_to_reach = 4;
  good.sensed.final_error_mm = 2.0;
  runs::TrialRecord bad;
  bad.truth.emplace().final_error_mm = 5.0;
  bad.truth->heading_error_deg = 5.5;
  bad.sensed.final_error_mm = 6.0;
  runs::TaskSummary summary = experiments::summarise_task({good, bad});
  REQUIRE(summary.truth);
  CHECK(summary.truth->mean_error_mm == Approx(3.0));
  CHECK(summary.truth->success_rate == Approx(0.5));
  CHECK(summary.truth->steps_to_reach == 4.0);
  CHECK(summary.truth->heading_error_deg == 5.5);
  CHECK_FALSE(summary.truth->hold_error_mm);
  CHECK(summary.sensed.mean_error_mm == Approx(4.0));
  CHECK(summary.n_trials == 2);
  CHECK(summary.stopped == 1);
  CHECK_FALSE(summary.unreachable);
  good.unreachable = false;
  bad.unreachable = true;
  CHECK(experiments::summarise_task({good, bad}).unreachable == 1);
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
