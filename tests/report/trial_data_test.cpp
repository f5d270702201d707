#include "../../src/report/trial_data.h"

#include <catch2/catch.hpp>

#include "report/small_run.h"

using namespace lodestone::report;
using lodestone::tests::path_trial;
using lodestone::tests::point_trial;

TEST_CASE("a point's reference is its target, its error the distance at the end") {
  const Trial trial = read_trials({point_trial("policy", "explored")}).front();
  CHECK(trial.track_is_true);
  CHECK(trial.distance_mm(0) == Approx(20.0));
  CHECK(trial.distance_mm(2) == Approx(0.5));
  CHECK(trial.error_mm == 0.5);
  CHECK(trial.approach == 0);
  CHECK(trial.current_A[1][1] == 7.5);
}

TEST_CASE("a path's reference moves, its error is that across the track, its approach counts") {
  const Trial trial = read_trials({path_trial("planner", "unseen")}).front();
  CHECK(trial.distance_mm(2) == Approx(5.0));
  CHECK(trial.error_mm == 2.25);
  CHECK(trial.approach == 2);
  CHECK_FALSE(trial.target_mm.has_value());
}

TEST_CASE("a trial that has headings brings them along") {
  lodestone::runs::TrialRecord record = path_trial("planner", "unseen");
  CHECK(read_trials({record}).front().reference_heading_rad.empty());
  record.reference_heading_rad = std::vector<double>{0.0, 0.5, 1.0};
  record.truth->heading_rms_deg = 7.5;
  const Trial path = read_trials({record}).front();
  CHECK(path.reference_heading_rad == std::vector<double>{0.0, 0.5, 1.0});
  CHECK(path.heading_rms_deg == 7.5);
  record = point_trial("planner", "unseen");
  record.target_heading_rad = 2.0;
  CHECK(read_trials({record}).front().target_heading_rad == 2.0);
}

TEST_CASE("a trial brings the obstacles along that were drawn for it") {
  lodestone::runs::TrialRecord record = point_trial("policy", "explored");
  CHECK(read_trials({record}).front().obstacles.empty());
  record.obstacles_mm = {{10.0, -5.0, 3.0}};
  const Trial trial = read_trials({record}).front();
  REQUIRE(trial.obstacles.size() == 1);
  CHECK(trial.obstacles[0].corners_mm.front() == std::pair(10.0, -5.0));
  CHECK(trial.obstacles[0].radius_mm == 3.0);
}

TEST_CASE(
    "zones that were told are those at the trial's begin and at its end, each once, without its obstacles") {
  lodestone::runs::TrialRecord record = point_trial("policy", "explored");
  CHECK(read_trials({record}).front().told_zones.empty());
  record.obstacles_mm = {{10.0, -5.0, 3.0}};
  const lodestone::runs::ZoneRecord obstacle{"obstacle 1", {{10.0, -5.0}}, 3.0};
  const auto at = [](double x_mm) { return lodestone::runs::ZoneRecord{"hand", {{x_mm, 0.0}}, 4.0}; };
  record.told_zones = {
      {0.0, {obstacle, at(1.0)}}, {0.3, {obstacle, at(2.0)}}, {0.6, {obstacle, at(3.0), at(1.0)}}};
  const Trial trial = read_trials({record}).front();
  CHECK(trial.obstacles.size() == 1);
  REQUIRE(trial.told_zones.size() == 2);
  CHECK(trial.told_zones[0].corners_mm.front() == std::pair(1.0, 0.0));
  CHECK(trial.told_zones[1].corners_mm.front() == std::pair(3.0, 0.0));
}

TEST_CASE("where nobody knows the true pose, the way is what was seen") {
  lodestone::runs::TrialRecord record = point_trial("policy", "real");
  record.trajectory.reset();
  record.truth.reset();
  const Trial trial = read_trials({record}).front();
  CHECK_FALSE(trial.track_is_true);
  REQUIRE(trial.track_mm.size() == 3);
  CHECK(trial.track_mm[1] == trial.track_mm[0]);  // not found: where it was before
  CHECK(trial.error_mm == 1.0);
}

TEST_CASE("trials are chosen by task and controller") {
  const auto trials = read_trials({point_trial("policy", "explored"), path_trial("policy", "explored"),
                                   point_trial("baseline", "explored")});
  CHECK(controllers_of(trials) == std::vector<std::string>{"policy", "baseline"});
  CHECK(select(trials, "point", "baseline").size() == 1);
  CHECK(select(trials, "circle", "policy").empty());
  CHECK(read_trials(DeployData{}).empty());
}
