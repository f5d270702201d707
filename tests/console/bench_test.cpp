#include "lodestone/console/bench.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>

#include "lodestone/common/error.h"

using namespace lodestone;
using console::Bench;
using console::BenchState;
using console::Goal;
using console::Mode;

namespace {

/// A virtual bench in real time, seen by the simulated sensor, under the baseline; and an operator whose page
/// beats as long as it is there.
struct Laboratory {
  Laboratory() {
    config.loop.rest_s = 0.1;
    config.sensor.kind = "simulated";
    config.trials.point_seconds = 1.0;
    Bench::Parts parts;
    parts.config = config;
    parts.sources = {experiments::baseline_source(config)};
    parts.connect = [this] {
      if (unplugged) throw common::HardwareError("no rig on this port");
      return session::make_virtual_session(config.rig, config.sensor, config.safety, {}, true);
    };
    parts.tell = [this](const console::BenchEvent& event) {
      const std::lock_guard<std::mutex> lock(mutex);
      events += event.text + "\n";
    };
    bench = std::make_unique<Bench>(parts);
    page = std::thread([this] {
      while (!over) {
        if (beats) bench->beat(visible, focused);
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
      }
    });
  }
  ~Laboratory() {
    over = true;
    page.join();
  }

  bool reach(const std::function<bool(const BenchState&)>& there) {
    for (int i = 0; i < 2000; ++i) {
      if (there(bench->state())) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    UNSCOPED_INFO("mode " << common::name_of(bench->state().mode) << ": " << bench->state().reason);
    return false;
  }
  bool reach(Mode mode) {
    return reach([mode](const BenchState& state) { return state.mode == mode; });
  }
  /// What an order came to; empty: done.
  std::string ask(const std::function<void(Bench::Done)>& order) {
    std::atomic<bool> answered{false};
    std::string why_not;
    order([&](const std::string& text) {
      why_not = text;
      answered = true;
    });
    while (!answered) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return why_not;
  }
  std::string arm() {
    return ask([this](Bench::Done done) { bench->arm(std::move(done)); });
  }
  std::string rearm(const std::string& reason) {
    return ask([&](Bench::Done done) { bench->rearm(reason, true, std::move(done)); });
  }
  bool told(const std::string& text) {
    return reach([&](const BenchState&) {
      const std::lock_guard<std::mutex> lock(mutex);
      return events.find(text) != std::string::npos;
    });
  }

  experiments::DeploymentConfig config;
  std::atomic<bool> unplugged{false}, beats{true}, visible{true}, focused{true}, over{false};
  std::mutex mutex;
  std::string events;
  std::unique_ptr<Bench> bench;
  std::thread page;
};

Goal point(double x_m, double y_m) {
  Goal goal;
  goal.task = "point";
  goal.target_m = {x_m, y_m};
  return goal;
}

}  // namespace

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

TEST_CASE("what was asked for before is not done later: a goal from before, a wish, a stop in between") {
  Laboratory lab;
  REQUIRE(lab.reach(Mode::kDisarmed));
  REQUIRE(lab.arm().empty());
  REQUIRE(lab.bench->set_unattended(true).empty());
  lab.bench->handed_over(true);
  CHECK_FALSE(lab.bench->state().unattended);  // who wished for it has gone
  REQUIRE(lab.bench->drive(point(0.01, 0.0)).empty());
  lab.bench->stop("before it began");
  REQUIRE(lab.reach(Mode::kStopped));
  CHECK(lab.told("coils off, as measured"));
  // Said again while it is being re-armed: whichever comes first, it is stopped, or armed before that stop.
  std::string why_not;
  std::atomic<bool> answered{false};
  lab.bench->rearm("before it began", false, [&](const std::string& text) {
    why_not = text;
    answered = true;
  });
  lab.bench->stop("again");
  while (!answered) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(lab.reach(Mode::kStopped));
  const std::string reason = lab.bench->state().reason;
  CHECK(lab.reach([](const BenchState& state) { return state.why_not.empty(); }));
  CHECK(lab.rearm(reason).empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  CHECK(lab.bench->state().mode == Mode::kArmed);  // the old goal does not drive
}
