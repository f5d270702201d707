#include "console/laboratory.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::Bench;
using console::BenchState;
using console::Mode;
using tests::Laboratory;
using tests::point;

TEST_CASE("a bench is armed, driven to a target and to another one, and ended") {
  Laboratory lab;
  CHECK_FALSE(lab.bench->drive(point(0.0, 0.0)).empty());  // not armed
  REQUIRE(lab.reach(Mode::kDisarmed));
  CHECK_THAT(lab.bench->drive(point(0.0, 0.0)), Catch::Contains("arm it first"));
  REQUIRE(lab.arm().empty());
  CHECK_FALSE(lab.arm().empty());
  CHECK_FALSE(lab.bench->choose("planner").empty());
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  REQUIRE(lab.reach(Mode::kRunning));
  CHECK(lab.bench->state().attended);
  CHECK_THAT(lab.bench->choose("hand"), Catch::Contains("under way"));
  const auto near = [](double x_m, double y_m) {
    return [=](const BenchState& state) {
      return state.pose && state.pose->valid &&
             (state.pose->pose.position_m() - geometry::Vector2(x_m, y_m)).norm() < 0.004;
    };
  };
  CHECK(lab.reach(near(0.01, 0.0)));
  REQUIRE(lab.bench->drive(point(0.0, 0.008)).empty());
  CHECK(lab.reach(near(0.0, 0.008)));
  CHECK(lab.bench->state().trail_m.size() > 3);
  CHECK(lab.bench->state().sample->duty[0] > 0.0);
  CHECK(lab.bench->samples().size() > 3);
  REQUIRE(lab.bench->end_run().empty());
  REQUIRE(lab.reach(Mode::kArmed));
  CHECK_FALSE(lab.bench->state().run);
  CHECK_FALSE(lab.bench->end_run().empty());
  CHECK(lab.ask([&](Bench::Done done) { lab.bench->disarm(std::move(done)); }).empty());
  CHECK(lab.bench->state().mode == Mode::kDisarmed);
}

TEST_CASE("a bench shows how the needle shall lie along a path that has headings") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  console::Goal path;
  path.task = "path";
  path.path = geometry::Path::circle(0.005).with_heading(geometry::PathHeading::fixed(0.5));
  REQUIRE(lab.bench->drive(path).empty());
  CHECK(lab.reach([](const BenchState& state) { return state.target_heading_rad == 0.5; }));
  CHECK(lab.bench->state().plan_headings.size() == 6);  // about 5 mm apart
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  CHECK(lab.reach([](const BenchState& state) { return state.target_m && !state.target_heading_rad; }));
}

TEST_CASE("a bench leads the needle through stitches, and shows how it shall lie") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  const console::Goal suture = console::suture_goal({});
  REQUIRE(lab.bench->drive(suture).empty());
  CHECK(lab.reach([&](const BenchState& state) {  // at the first one
    return state.target_m && (*state.target_m - suture.stitches.front().entry.position_m()).norm() < 1e-9 &&
           state.target_heading_rad && std::abs(*state.target_heading_rad - 0.5 * geometry::kPi) < 1e-9;
  }));
  CHECK(lab.bench->state().run->task == "suture");
  CHECK(lab.bench->state().plan_m.size() == suture.path->points_m().size());
  CHECK(lab.bench->state().plan_headings.size() > 10);
}

TEST_CASE("a controller that cannot be had stops the bench, and another one drives after that") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->choose("broken").empty());
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK(lab.bench->state().reason == "its weights are gone");
  CHECK(lab.told("coils off, as measured"));
  REQUIRE(lab.reach([](const BenchState& state) { return state.why_not.empty(); }));
  REQUIRE(lab.rearm("its weights are gone").empty());
  REQUIRE(lab.bench->choose("baseline").empty());
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  CHECK(lab.reach(Mode::kRunning));
}

TEST_CASE("a target that no way leads to stops the bench, and says so") {
  const std::vector<geometry::Zone> wall = {{"wall", {0.025, -0.05, 0.025, 0.05}, 0.001}};
  Laboratory lab(wall);
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->drive(point(0.0, 0.002)).empty());
  REQUIRE(lab.reach([](const BenchState& state) { return state.run && state.run->steps > 2; }));
  REQUIRE(lab.bench->drive(point(0.035, 0.0)).empty());
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK_THAT(lab.bench->state().reason, Catch::Contains("no way leads"));
}

TEST_CASE("a point that the needle is led to by a way stays the target that is shown") {
  const std::vector<geometry::Zone> post = {{"post", {0.02, 0.0}, 0.002}};
  Laboratory lab(post);
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->drive(point(0.035, 0.0)).empty());
  REQUIRE(lab.reach([](const BenchState& state) { return state.run && state.run->steps > 2; }));
  const BenchState shown = lab.bench->state();
  REQUIRE(shown.target_m);
  CHECK((*shown.target_m - geometry::Vector2(0.035, 0.0)).norm() < 1e-12);
}

TEST_CASE("zones of a file move while the bench is idle and while it drives, and no zones stop it") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "moving.json";
  const auto tell = [&path](const std::string& name) {
    common::write_file_atomically(
        path, R"({"keep_out": [{"name": ")" + name + R"(", "corners_m": [-0.03, 0.0], "radius_m": 0.002}]})");
  };
  const auto shows = [](const std::string& name) {
    return [name](const BenchState& state) {
      return state.keep_out.zones.size() == 1 && state.keep_out.zones.front().name == name;
    };
  };
  tell("first");
  Laboratory lab({}, path);
  CHECK(shows("first")(lab.bench->state()));
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  common::write_file_atomically(path, "{}");
  CHECK(lab.told("a run will be stopped"));
  CHECK(shows("first")(lab.bench->state()));
  tell("second");
  CHECK(lab.reach(shows("second")));
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  REQUIRE(lab.reach([](const BenchState& state) { return state.run && state.run->steps > 2; }));
  tell("third");
  CHECK(lab.reach(shows("third")));
  CHECK(lab.bench->state().mode == Mode::kRunning);
  common::write_file_atomically(path, "{}");
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK_THAT(lab.bench->state().reason, Catch::Contains(path));
}

TEST_CASE(
    "no way leads beyond a wall that a file tells of, before the target is given or while the way is gone") {
  const bool under_way = GENERATE(false, true);
  CAPTURE(under_way);
  const tests::TemporaryFolder folder;
  const std::string path = folder / "moving.json";
  const auto tell = [&path](const std::string& zones) {
    common::write_file_atomically(path, "{\"keep_out\": [" + zones + "]}");
  };
  const std::string wall = R"({"name": "wall", "corners_m": [0.028, -0.05, 0.028, 0.05], "radius_m": 0.001})";
  tell("");
  Laboratory lab({}, path);
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->drive(point(-0.02, 0.0)).empty());
  REQUIRE(lab.reach([](const BenchState& state) {  // far from where the wall will be
    return state.run && state.pose && state.pose->valid && state.pose->pose.x_m < -0.015;
  }));
  if (!under_way) {
    tell(wall);
    REQUIRE(lab.reach([](const BenchState& state) { return state.keep_out.zones.size() == 1; }));
  }
  REQUIRE(lab.bench->drive(point(0.035, 0.0)).empty());
  if (under_way) tell(wall);
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK_THAT(lab.bench->state().reason, Catch::Contains("no way leads"));
}

TEST_CASE("an unattended run needs no page, and ends with its task") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->set_unattended(true).empty());
  lab.beats = false;
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  REQUIRE(lab.reach(Mode::kRunning));
  CHECK(lab.bench->state().unattended);
  CHECK_FALSE(lab.bench->set_unattended(false).empty());
  REQUIRE(lab.reach(Mode::kArmed));
  CHECK(lab.told("run ended: done"));
  CHECK_FALSE(lab.bench->state().unattended);  // for one run
}
