#include "lodestone/experiments/trial.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/files.h"
#include "lodestone/control/dipole_pull.h"
#include "lodestone/session/rig_session.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// A trial by the baseline on a virtual rig; `true_pose` may be empty.
struct Bench {
  explicit Bench(const safety::SafetyConfig& safety = {}) {
    session::SensingConfig sensing;
    sensing.kind = "simulated";
    session = session::make_virtual_session(rig, sensing, safety, {});
    plan.task = "point";
    plan.start = {0.015, 0.0, 0.0};
    plan.duration_s = 3.0;
  }
  experiments::TrialResult run(const experiments::TruePose& true_pose) {
    session->place(plan.start);
    task::ActionConfig action;
    action.scale = rig.coils.max_current_A;
    control::ControlLoop loop({}, action, session->coils(), session->sensor(), session->clock());
    control::DipolePullController controller(rig, {});
    return experiments::run_trial(plan, loop, controller, true_pose, {}, watch,
                                  {[this] { return session->coils().reported(); }, zones});
  }
  std::function<std::vector<geometry::Zone>()> zones;
  experiments::TrialWatch watch;
  rig::RigConfig rig;
  std::unique_ptr<session::RigSession> session;
  experiments::TrialPlan plan;
};

}  // namespace

TEST_CASE("a trial is scored by true poses and as it was sensed") {
  Bench bench;
  const auto result = bench.run([&] { return bench.session->truth()->true_pose(); });
  CHECK(result.completed);
  REQUIRE(result.truth);
  CHECK(result.truth->final_error_mm == Approx(result.sensed.final_error_mm).margin(2.0));
  CHECK(result.samples.size() >= 10);
  CHECK(result.samples.back().temperature_C);
  CHECK(result.samples.back().step.last);
}

TEST_CASE("where nobody knows the true pose, nothing stands for it") {
  Bench bench;
  const auto result = bench.run({});
  CHECK_FALSE(result.truth);
  CHECK_FALSE(result.samples.front().true_pose);
  CHECK(result.sensed.final_error_mm > 0.0);
}

TEST_CASE("a trial that is stopped at once is scored where the needle was to lie, and failed") {
  Bench bench;
  bench.session->coils().request_stop("no");
  const auto result = bench.run([&] { return bench.session->truth()->true_pose(); });
  CHECK_FALSE(result.completed);
  CHECK_FALSE(result.stop_reason.empty());
  CHECK_FALSE(result.truth->success);
  CHECK(result.truth->final_error_mm == Approx(15.0).margin(1e-3));
}

TEST_CASE("a trial that is stopped on its path is scored to the end of the schedule, where the needle lies") {
  Bench bench;
  bench.plan.path = geometry::Path({{0.015, 0.0}, {0.009, 0.0}}, false);
  experiments::TrialPlan& plan = bench.plan;
  plan.task = "path";
  const auto whole = bench.run([&] { return bench.session->truth()->true_pose(); });
  CHECK(whole.completed);
  int seen = 0;
  const auto stopped = bench.run([&] {
    if (++seen == 3) bench.session->coils().request_stop("no");
    return bench.session->truth()->true_pose();
  });
  CHECK_FALSE(stopped.completed);
  CHECK(stopped.samples.size() < whole.samples.size());
  REQUIRE(stopped.truth);
  CHECK_FALSE(stopped.truth->success);
  CHECK(*stopped.truth->completion < *whole.truth->completion);
  CHECK(*stopped.truth->corners_reached == 0.5);  // the ends of an open path: it began at one
  CHECK(stopped.truth->final_error_mm > 3.0);
  CHECK(stopped.sensed.final_error_mm > 3.0);
}

TEST_CASE("a heading along a path is scored to the end of the schedule, as the needle lies") {
  Bench bench;
  bench.plan.path = geometry::Path({{0.015, 0.0}, {0.009, 0.0}}, false)
                        .with_heading(geometry::PathHeading::fixed(geometry::kPi / 2.0));
  bench.plan.task = "path";
  const auto whole = bench.run([] { return geometry::Pose2{0.015, 0.0, geometry::kPi / 2.0}; });
  REQUIRE(whole.completed);
  REQUIRE(whole.samples.size() == 11);
  CHECK(*whole.samples[4].step.target_heading_rad == Approx(geometry::kPi / 2.0));
  CHECK(*whole.truth->heading_rms_deg == Approx(0.0).margin(1e-6));
  CHECK(*whole.sensed.heading_rms_deg > 1.0);  // it truly lay otherwise
  CHECK_FALSE(whole.truth->heading_error_deg);
  int seen = 0;
  const auto stopped = bench.run([&] {
    if (++seen == 3) bench.session->coils().request_stop("no");
    return geometry::Pose2{0.015, 0.0, seen > 3 ? 0.0 : geometry::kPi / 2.0};
  });
  CHECK_FALSE(stopped.completed);
  CHECK(*stopped.truth->heading_rms_deg == Approx(90.0 * std::sqrt(8.0 / 11.0)));
}

TEST_CASE("a trial is scored by the zones that its needle keeps out of") {
  Bench bench;
  const auto still = [&] { return bench.plan.start; };
  bench.plan.target_m = bench.plan.start.position_m();
  const auto without = bench.run(still);
  CHECK_FALSE(without.truth->clearance_mm);
  CHECK(without.truth->success);
  bench.plan.keep_out = {{{"far", {-0.03, 0.0}, 0.002}}, 0.01, 0.001, 0.001};
  const auto clear = bench.run(still);
  CHECK(*clear.truth->clearance_mm == Approx(37.5));  // from the tail at 10 mm
  CHECK(clear.truth->success);
  CHECK(clear.sensed.clearance_mm);
  bench.plan.keep_out.zones.front().corners_m = {0.02, 0.0};
  const auto touching = bench.run(still);
  CHECK(touching.completed);  // nobody keeps it out here, but it is scored
  CHECK(*touching.truth->touches == 1);
  CHECK_FALSE(touching.truth->success);
}

TEST_CASE("a needle is led to a point by a way, and scored by its distance to that point alone") {
  Bench bench;
  bench.plan.start = {-0.02, 0.0, 0.0};
  bench.plan.target_m = {0.02, 0.0};
  bench.plan.keep_out = {{{"disc", {0.0, 0.0}, 0.002}}, 0.01, 0.001, 0.001};
  bench.plan.routes = std::make_shared<const task::RouteMap>(task::Region::disc(0.04, 0.004),
                                                             std::vector<task::Move>(), task::RouteConfig());
  // A needle that does not move is sent to the first point of the way, and is as far from the target as ever.
  const auto result = bench.run([&] { return bench.plan.start; });
  CHECK(result.completed);
  const geometry::Vector2 aimed_m = result.samples.front().step.target_m;
  CHECK((aimed_m - bench.plan.target_m).norm() > 0.005);
  CHECK(std::abs(aimed_m.y()) > 0.003);  // past the disc
  CHECK(result.truth->final_error_mm == Approx(40.0));
  bench.plan.keep_out.zones = {{"wall", {0.0, -0.05, 0.0, 0.05}, 0.001}};
  const auto blocked = bench.run([&] { return bench.plan.start; });
  CHECK_FALSE(blocked.completed);
  CHECK_THAT(blocked.stop_reason, Catch::Contains("no way leads"));
  CHECK_FALSE(blocked.truth->success);
}

TEST_CASE("zones that move are led around, kept, and scored by the moment") {
  Bench bench;
  bench.plan.start = {-0.02, 0.0, 0.0};
  bench.plan.target_m = {0.02, 0.0};
  const std::vector<geometry::Zone> above = {{"wall", {0.0, -0.002, 0.0, 0.05}, 0.001}};
  const std::vector<geometry::Zone> below = {{"wall", {0.0, 0.002, 0.0, -0.05}, 0.001}};
  bench.plan.keep_out = {above, 0.01, 0.001, 0.001};
  bench.plan.routes = std::make_shared<const task::RouteMap>(task::Region::disc(0.04, 0.004),
                                                             std::vector<task::Move>(), task::RouteConfig());
  int told = 0;
  bench.zones = [&] { return ++told <= 2 ? above : below; };
  const auto result = bench.run([&] { return bench.plan.start; });
  REQUIRE(result.completed);
  REQUIRE(result.told_zones.size() == 2);
  CHECK(result.told_zones.front().time_s == 0.0);
  CHECK(result.told_zones.back().time_s == result.samples[1].step.time_s);
  CHECK(result.told_zones.back().zones == below);
  CHECK(result.told_zones.front().zones == above);
  CHECK(result.samples[0].step.target_m.y() < -1e-3);  // past its end
  CHECK(std::any_of(result.samples.begin() + 2, result.samples.end(), [](const auto& sample) {
    return sample.step.target_m.y() > 1e-3;  // past the other's
  }));
  // A needle that lies where the disc comes to touches it then, and not before.
  bench.plan.target_m = {-0.02, 0.004};
  const std::vector<geometry::Zone> here = {{"disc", {-0.02, 0.0}, 0.001}};
  told = 0;
  bench.zones = [&] { return ++told <= 4 ? above : told <= 6 ? here : above; };
  bench.plan.routes.reset();
  const auto touched = bench.run([&] { return bench.plan.start; });
  CHECK(touched.told_zones.size() == 3);
  CHECK(*touched.truth->touches == 1);
  CHECK(*touched.truth->clearance_mm <= 0.0);
  told = 0;
  bench.zones = [&] { return ++told, above; };
  CHECK(*bench.run([&] { return bench.plan.start; }).truth->touches == 0);
  CHECK(told > 5);
}

TEST_CASE("the supervisor keeps a needle out of zones that a file tells while it is driven") {
  const tests::TemporaryFolder folder;
  safety::SafetyConfig safety;
  safety.keep_out_file = folder / "moving.json";
  const auto tell = [&](const std::string& text) {
    common::write_file_atomically(safety.keep_out_file, text);
  };
  tell(R"({"keep_out": []})");
  Bench bench(safety);
  bench.zones = [&bench] { return bench.session->coils().keep_out(); };
  bench.plan.keep_out = safety.keeps_out(bench.rig);
  int seen = 0;
  std::string then = R"({"keep_out": [{"name": "hand", "corners_m": [0.0, 0.0], "radius_m": 0.04}]})";
  bench.watch = [&](const experiments::TrialSample&) {
    if (++seen == 3) tell(then);
  };
  const auto truth = [&bench] { return bench.session->truth()->true_pose(); };
  const auto result = bench.run(truth);
  CHECK_FALSE(result.completed);
  CHECK_THAT(result.stop_reason, Catch::Contains("keep-out zone hand"));
  CHECK(result.samples.size() == 3);
  CHECK(*result.truth->touches == 1);  // it lies in the zone that stopped it
  REQUIRE(result.told_zones.size() == 2);
  CHECK(result.told_zones.back().time_s > result.samples.back().step.time_s);
  CHECK(result.told_zones.back().zones.front().name == "hand");
  CHECK_THROWS_WITH((tell("nonsense"), bench.session->coils().rearm()),
                    Catch::Contains(safety.keep_out_file));
  tell(R"({"keep_out": []})");
  bench.session->coils().rearm();
  seen = 0;
  then = "nonsense";
  const auto unreadable = bench.run(truth);
  CHECK_FALSE(unreadable.completed);
  CHECK_THAT(unreadable.stop_reason, Catch::Contains(safety.keep_out_file));
}

TEST_CASE("a heading that is off fails a trial of a pose") {
  Bench bench;
  bench.plan.target_m = bench.plan.start.position_m();
  bench.plan.target_heading_rad = 2.0;
  const auto result = bench.run([] { return geometry::Pose2{0.015, 0.0, 0.0}; });
  REQUIRE(result.truth->heading_error_deg);
  CHECK(*result.truth->heading_error_deg == Approx(114.6).margin(0.1));
  CHECK_FALSE(result.truth->success);
}

namespace {

/// A needle that lies before a stitch of 6 mm leftwards, which takes 1.2 s, with another one to follow.
Bench before_stitches() {
  Bench bench;
  bench.plan.task = "suture";
  bench.plan.start = {0.015, 0.0, geometry::kPi};
  bench.plan.stitches = {{{0.012, 0.0, geometry::kPi}, {0.006, 0.0, geometry::kPi}},
                         {{-0.01, 0.01, 0.0}, {-0.004, 0.01, 0.0}}};
  bench.plan.suture.speed_m_s = 0.01;
  bench.plan.suture.arrive_m = 0.003;  // as it is sensed
  bench.plan.suture.arrive_limit_s = 0.9;
  bench.plan.suture.approach_m = bench.plan.suture.leave_m = 0.003;
  return bench;
}

}  // namespace

TEST_CASE("a needle is led through stitches, and each is scored by where it was pushed through") {
  Bench bench = before_stitches();
  int seen = 0;
  const auto pulled = [&] {  // along the first stitch, and then no further
    return geometry::Pose2{0.015 - 0.003 * std::min(4, seen++), 0.0, geometry::kPi};
  };
  const auto result = bench.run(pulled);
  REQUIRE(result.completed);
  // 1.2 s through the first one, 0.9 s waiting for the second, 1.2 s through that.
  REQUIRE(result.samples.size() == 12);
  CHECK_FALSE(result.samples[0].approach);  // it lay there
  CHECK(result.samples[3].stitch == 0);
  CHECK(result.samples[4].stitch == 1);
  CHECK(result.samples[4].approach);
  CHECK(result.samples[4].step.target_m.x() == Approx(-0.013));
  CHECK(*result.samples[4].step.target_heading_rad == Approx(0.0).margin(1e-9));
  CHECK_FALSE(result.samples[7].approach);
  REQUIRE(result.truth);
  CHECK(*result.truth->stitches_made == 1);
  CHECK(*result.truth->stitches_made_share == 0.5);
  CHECK_FALSE(result.truth->success);
  CHECK(result.truth->stitch_figures->at(0).made);
  CHECK(result.truth->stitch_figures->at(1).entry_error_mm > 10.0);
  CHECK(result.sensed.stitches_made);
  CHECK_FALSE(result.truth->completion);
  CHECK_FALSE(result.truth->heading_error_deg);
}

TEST_CASE("a needle is led to where is aimed, and scored by the stitches themselves") {
  Bench bench = before_stitches();
  bench.plan.aims = bench.plan.stitches;
  for (geometry::Stitch& aim : bench.plan.aims) aim.entry.y_m += 0.0004;
  int seen = 0;
  const auto result = bench.run([&] {
    return geometry::Pose2{0.015 - 0.003 * std::min(4, seen++), 0.0, geometry::kPi};
  });
  CHECK(result.samples[0].step.target_m.y() == Approx(0.0004));
  CHECK(result.truth->stitch_figures->at(0).entry_error_mm == Approx(0.0).margin(1e-6));
  CHECK(result.plan.stitches[0].entry.y_m == 0.0);
}

TEST_CASE("a trial that is stopped in its suture is scored to the end of the schedule, and has failed") {
  Bench bench = before_stitches();
  bench.plan.stitches.pop_back();
  int seen = 0;
  const auto stopped = bench.run([&] {
    if (++seen == 3) bench.session->coils().request_stop("no");
    return geometry::Pose2{0.015 - 0.003 * std::min(2, seen - 1), 0.0, geometry::kPi};
  });
  CHECK_FALSE(stopped.completed);
  CHECK(*stopped.truth->stitches_made == 0);
  CHECK(stopped.truth->stitch_figures->front().entry_error_mm == Approx(0.0).margin(1e-6));
  CHECK(stopped.truth->stitch_figures->front().exit_error_mm == Approx(3.0));
  Bench before = before_stitches();
  before.session->coils().request_stop("no");
  const auto never = before.run([&] { return before.plan.start; });
  CHECK_FALSE(never.truth->success);
  CHECK(never.truth->stitch_figures->front().exit_error_mm == Approx(9.0));
}
