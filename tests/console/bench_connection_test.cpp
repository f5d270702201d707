#include "console/laboratory.h"

using namespace lodestone;
using console::Bench;
using console::Mode;
using tests::Laboratory;
using tests::point;

TEST_CASE("a rig that is not there is waited for, and one that is let go of is left alone") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.ask([&](Bench::Done done) { lab.bench->let_go("collecting", std::move(done)); }).empty());
  CHECK(lab.bench->state().mode == Mode::kDisconnected);
  CHECK(lab.bench->state().reason == "collecting");
  CHECK_THAT(lab.bench->drive(point(0.0, 0.0)), Catch::Contains("not connected"));
  lab.bench->stop("before it was there");
  CHECK(lab.bench->state().mode == Mode::kDisconnected);
  lab.unplugged = true;
  lab.bench->take_up();
  CHECK(lab.told("no rig on this port"));
  lab.unplugged = false;
  CHECK(lab.reach(Mode::kStopped));  // who said stop meanwhile is heard
  CHECK(lab.bench->state().reason == "before it was there");
  CHECK(lab.rearm("before it was there").empty());
}
