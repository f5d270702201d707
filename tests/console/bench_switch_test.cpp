#include "console/laboratory.h"

using namespace lodestone;
using console::BenchState;
using console::Mode;
using tests::Laboratory;
using tests::point;

TEST_CASE("a run whose page falls silent or is hidden is stopped, and taken up only by who has seen why") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->drive(point(0.02, 0.0)).empty());
  REQUIRE(lab.reach(Mode::kRunning));
  std::string expected;
  SECTION("silent") {
    lab.beats = false;
    expected = "silent";
  }
  SECTION("hidden") {
    lab.visible = false;
    expected = "hidden";
  }
  SECTION("handed over to nobody, who does not beat") {
    lab.beats = false;
    lab.bench->handed_over(false);
    expected = "silent";
  }
  SECTION("somebody says stop") {
    lab.bench->stop("the red button");
    expected = "red button";
  }
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK(lab.told("coils off, as measured"));
  const std::string reason = lab.bench->state().reason;
  CHECK_THAT(reason, Catch::Contains(expected));
  CHECK_THAT(lab.bench->drive(point(0.0, 0.0)), Catch::Contains("re-arm it first"));
  CHECK_FALSE(lab.arm().empty());
  CHECK_THAT(lab.rearm("another reason"), Catch::Contains(expected));
  CHECK(lab.bench->state().mode == Mode::kStopped);
  CHECK(lab.reach([](const BenchState& state) { return state.why_not.empty(); }));
  lab.beats = lab.visible = true;
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // a beat
  CHECK(lab.rearm(reason).empty());
  REQUIRE(lab.bench->drive(point(0.0, 0.0)).empty());
  CHECK(lab.reach([](const BenchState& state) { return state.run && state.run->steps > 1; }));
}

TEST_CASE("a hand drives for as long as it is felt, in a page that has the focus") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  CHECK_FALSE(lab.bench->hold({1.0, 0.0}).empty());
  REQUIRE(lab.bench->choose("hand").empty());
  CHECK_FALSE(lab.bench->drive(point(0.0, 0.0)).empty());
  std::atomic<bool> held{true};
  std::thread hand([&] {
    while (held) {
      lab.bench->hold({0.5, 0.0});
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  CHECK(lab.reach([](const BenchState& state) { return state.run && state.run->steps > 2; }));
  SECTION("let go") {
    held = false;
    hand.join();
    CHECK(lab.bench->hold({0.0, 0.0}).empty());
  }
  SECTION("no word of it") {
    held = false;
    hand.join();
  }
  SECTION("the focus is lost") {
    lab.focused = false;
    CHECK(lab.told("lost the focus"));
    held = false;
    hand.join();
  }
  REQUIRE(lab.reach(Mode::kArmed));  // a pulse train ends; nothing is latched
  CHECK(lab.told("run ended"));
}
