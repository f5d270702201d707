#include "lodestone/control/control_loop.h"

#include <sched.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "control/fakes.h"
#include "env/linear_model.h"
#include "lodestone/common/realtime.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/rig/virtual_rig.h"
#include "lodestone/safety/supervisor.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

constexpr double kLinearGain_m = 0.8e-3;  // per ampere, of the rig that is identified

control::RigIdentifier identifier_of_linear_rig() {
  return {std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(kLinearGain_m)),
          {},
          1.0};
}

struct Bench {
  control::ControlLoopConfig config;
  safety::SafetyConfig safety;
  task::ActionConfig action = tests::paper_action();
  tests::RecordingCoils device;
  tests::ManualClock clock;
  tests::ScriptedSensor sensor{clock};
  double duration_s = 1.5;

  control::LoopOutcome run(control::Controller& controller, control::RigIdentifier* identifier = nullptr) {
    control::PointReference reference({0.01, 0.0}, duration_s);
    return run(controller, reference, identifier);
  }
  control::LoopOutcome run(control::Controller& controller, control::Reference& reference,
                           control::RigIdentifier* identifier = nullptr) {
    safety::Supervisor coils(device, safety, tests::paper_rig(), clock);
    control::ControlLoop loop(config, action, coils, sensor, clock, nullptr, identifier);
    return loop.run(controller, reference);
  }
};

}  // namespace

TEST_CASE("the loop pulses at the rig's clock and hands the controller its memory") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  bench.sensor.push(0.002, 0.001);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(2.0, -0.5); });
  const auto outcome = bench.run(controller);
  REQUIRE(outcome.completed);
  CHECK(outcome.stop_reason.empty());
  REQUIRE(bench.device.pulses.size() == 5);
  REQUIRE(outcome.steps.size() == 6);
  CHECK(outcome.steps.back().last);
  CHECK(bench.clock.now_s() == Approx(101.5));
  const auto& pulse = bench.device.pulses.front();
  CHECK(pulse.duration_s == Approx(0.1));
  CHECK(pulse.current_A[0] == Approx(15.0));  // clipped to 1
  CHECK(pulse.current_A[1] == 0.0);
  CHECK(pulse.current_A[3] == Approx(7.5));
  REQUIRE(controller.seen.size() == 5);
  CHECK(controller.seen[0].last_action.isZero());
  CHECK(controller.seen[0].last_displacement_m.isZero());
  CHECK(controller.seen[0].target_m.x() == 0.01);
  CHECK(controller.seen[1].last_action == Vector2(1.0, -0.5));
  CHECK(controller.seen[1].last_displacement_m == Vector2(0.002, 0.001));
  CHECK_FALSE(bench.device.on);
}

TEST_CASE("a loop whose actions would give no current is refused") {
  Bench bench;
  bench.action.scale = 0.0;
  tests::FunctionController controller([](const task::Observation&) { return Vector2(1.0, 0.0); });
  CHECK_THROWS_WITH(bench.run(controller), Catch::Contains("rig.coils.max_current_A"));
}

TEST_CASE("a controller is told the next points of a path, and of a point that it stays") {
  Bench bench;
  for (int step = 0; step < 8; ++step) bench.sensor.push(0.0, 0.0);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.1, 0.0); });
  bench.run(controller);
  CHECK(controller.seen.front().ahead.empty());
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  control::PathReference reference(geometry::Path({{0.0, 0.0}, {0.01, 0.0}}, false), config);
  controller.seen.clear();
  bench.run(controller, reference);
  const auto& ahead = controller.seen.front().ahead;
  REQUIRE(ahead.size() >= 10);
  CHECK(ahead[1].in_s == Approx(0.6));
  CHECK(ahead[1].point_m.x() == Approx(0.006));
  CHECK_FALSE(controller.seen.front().target_heading_rad);
}

TEST_CASE("a controller is told how the needle shall lie along a path, and so is whoever looks on") {
  Bench bench;
  for (int step = 0; step < 8; ++step) bench.sensor.push(0.0, 0.0);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.1, 0.0); });
  control::PathReferenceConfig config;
  config.speed_m_s = 0.01;
  control::PathReference reference(geometry::Path({{0.0, 0.0}, {0.01, 0.0}}, false)
                                       .with_heading(geometry::PathHeading::column({0.0, 1.0})),
                                   config);
  const auto outcome = bench.run(controller, reference);
  REQUIRE(outcome.steps.size() >= 3);
  CHECK(*controller.seen[1].target_heading_rad == Approx(0.3));
  CHECK(*controller.seen[1].ahead[0].heading_rad == Approx(0.6));
  CHECK(*outcome.steps[1].target_heading_rad == Approx(0.3));
}

TEST_CASE("a controller is told that its needle is waited for") {
  Bench bench;
  for (int step = 0; step < 8; ++step) bench.sensor.push(0.0, 0.0);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.1, 0.0); });
  control::SutureReferenceConfig config;
  config.arrive_limit_s = 0.5;
  control::SutureReference reference(geometry::running_stitch(1, 0.006, 0.004), config);
  bench.run(controller, reference);
  REQUIRE(controller.seen.size() >= 3);
  CHECK(controller.seen[0].awaited);
  CHECK(controller.seen[1].awaited);
  CHECK_FALSE(controller.seen[2].awaited);
}

TEST_CASE("every fault stops the coils and is the reason of the outcome") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  tests::FunctionController steady([](const task::Observation&) { return Vector2(0.5, 0.0); });
  std::string expected;
  control::LoopOutcome outcome;
  SECTION("coils that do not answer") {
    bench.device.fail_at = 2;
    outcome = bench.run(steady);
    expected = "no answer";
    CHECK(bench.device.pulses.size() == 2);
  }
  SECTION("a sensor that throws") {
    bench.sensor.throws = true;
    outcome = bench.run(steady);
    expected = "camera unplugged";
    CHECK(bench.device.pulses.empty());
  }
  SECTION("a controller that throws") {
    tests::FunctionController controller(
        [](const task::Observation&) -> Vector2 { throw std::runtime_error("bad weights"); });
    outcome = bench.run(controller);
    expected = "bad weights";
    CHECK(bench.device.pulses.empty());
  }
  SECTION("a controller that throws something odd") {
    tests::FunctionController controller([](const task::Observation&) -> Vector2 { throw 7; });
    outcome = bench.run(controller);
    expected = "unknown fault";
  }
  SECTION("a controller that asks for NaN") {
    tests::FunctionController controller([](const task::Observation&) { return tests::nan_action(); });
    outcome = bench.run(controller);
    expected = "not a number";
    CHECK(bench.device.pulses.empty());
  }
  SECTION("a fault that the coils report") {
    bench.device.state.faults = {"driver 2 overheated"};
    outcome = bench.run(steady);
    expected = "driver 2 overheated";
    CHECK(bench.device.pulses.empty());
  }
  SECTION("too many observations without a pose") {
    bench.config.max_invalid_poses = 3;
    bench.sensor.push_invalid("no needle in the image");
    outcome = bench.run(steady);
    expected = "no pose for 3 observations in a row: no needle in the image";
    CHECK(bench.device.pulses.size() == 1);
  }
  CHECK_FALSE(outcome.completed);
  CHECK_THAT(outcome.stop_reason, Catch::Contains(expected));
  CHECK(bench.device.stops >= 1);
  CHECK_FALSE(bench.device.on);
}

TEST_CASE("without a pose there is no pulse, and the loop goes on when it is back") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  bench.sensor.push_invalid("glare");
  bench.sensor.push_invalid("glare");
  bench.sensor.push(0.004, 0.0);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.5, 0.0); });
  const auto outcome = bench.run(controller);
  REQUIRE(outcome.completed);
  CHECK(bench.device.pulses.size() == 3);
  REQUIRE(controller.seen.size() == 3);
  CHECK(controller.seen[1].last_action.isZero());  // nothing was given at the step before
  CHECK(controller.seen[1].last_displacement_m == Vector2(0.004, 0.0));
  SECTION("a pose that is not a number counts as none") {
    Bench other;
    other.config.max_invalid_poses = 2;
    other.sensor.push(std::numeric_limits<double>::quiet_NaN(), 0.0);
    const auto stopped = other.run(controller);
    CHECK_FALSE(stopped.completed);
    CHECK(other.device.pulses.empty());
  }
}

TEST_CASE(
    "where head and tail are not told apart, what is asked for either way is given, and nothing learned") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  bench.sensor.push_either_way(0.002, 0.0, 0.5);
  bench.sensor.push(0.004, 0.0);
  control::RigIdentifier identifier = identifier_of_linear_rig();
  control::DipolePullController pull(tests::paper_rig(), {});
  const auto drive = [&](control::Controller& controller) {
    safety::Supervisor coils(bench.device, bench.safety, tests::paper_rig(), bench.clock);
    control::ControlLoop loop(bench.config, bench.action, coils, bench.sensor, bench.clock, nullptr,
                              &identifier);
    control::PointReference reference({0.02, 0.0}, 0.9);
    return loop.run(controller, reference);
  };
  SECTION("a controller that can be asked") {
    const auto outcome = drive(pull);
    REQUIRE(outcome.completed);
    CHECK(bench.device.pulses.size() == 3);
    const control::StepRecord& step = outcome.steps[1];
    CHECK(step.either_way);
    CHECK_FALSE(step.estimate.valid);
    CHECK_FALSE(step.drive_gain);
    CHECK(step.current_A[0] > 0.0);
    CHECK(outcome.steps[2].drive_gain->log_mean == outcome.steps[0].drive_gain->log_mean);
    CHECK_FALSE(outcome.steps[2].either_way);
  }
  SECTION("one that cannot") {
    tests::FunctionController controller([](const task::Observation&) { return Vector2(0.5, 0.0); });
    CHECK(drive(controller).completed);
    CHECK(bench.device.pulses.size() == 2);
    CHECK(controller.seen[1].last_action.isZero());
  }
}

TEST_CASE("a run of steps at which head and tail are not told apart ends like one without a pose") {
  Bench bench;
  bench.config.max_invalid_poses = 4;
  bench.sensor.push(0.0, 0.0);
  bench.sensor.push_either_way(0.002, 0.0, 0.5);
  control::DipolePullController pull(tests::paper_rig(), {});
  const auto outcome = bench.run(pull);
  CHECK_THAT(outcome.stop_reason, Catch::Contains("no pose for 4"));
  CHECK(bench.device.pulses.size() == 4);
}

namespace {

/// A clock on which every rest lasts for ever, unless somebody ends it.
class EndlessClock final : public common::Clock {
 public:
  double now_s() const override { return 100.0; }
  bool wait_until(double, common::Interruption* interruption) override {
    while (interruption == nullptr || !interruption->raised()) std::this_thread::yield();
    return false;
  }
};

}  // namespace

namespace {

/// Is held up once, at this decision.
class HeldUp final : public control::Controller {
 public:
  HeldUp(tests::ManualClock& clock, int decision, double for_s)
      : clock_(clock), decision_(decision), for_s_(for_s) {}
  void reset() override { decided_ = 0; }
  geometry::Drive act(const task::Observation&) override {
    if (decided_++ == decision_) clock_.sleep_until(clock_.now_s() + for_s_);
    pulses_at_s.push_back(clock_.now_s());
    return {0.1, 0.0};
  }

  std::vector<double> pulses_at_s;

 private:
  tests::ManualClock& clock_;
  int decision_;
  double for_s_;
  int decided_ = 0;
};

}  // namespace

TEST_CASE("a needle rests after a pulse that came late as after any other") {
  const int decision = GENERATE(0, 2);
  const double for_s = GENERATE(0.05, 0.4);
  Bench bench;
  bench.duration_s = 3.0;
  bench.sensor.push(0.0, 0.0);
  HeldUp controller(bench.clock, decision, for_s);
  const control::LoopOutcome outcome = bench.run(controller);
  CHECK(outcome.completed);
  const std::vector<double>& at_s = controller.pulses_at_s;
  REQUIRE(at_s.size() > 5);
  for (std::size_t i = 1; i < at_s.size(); ++i) {
    CAPTURE(decision, for_s, i);
    // A little is caught up, so that the schedule stays; what would cost the rest is not.
    CHECK(at_s[i] - at_s[i - 1] > bench.config.period_s() * (for_s > 0.1 ? 1.0 : 2.0 / 3.0) - 1e-9);
  }
}

TEST_CASE("a pulse long after its pose is not given") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  HeldUp controller(bench.clock, 1, 0.6);
  const control::LoopOutcome outcome = bench.run(controller);
  CHECK_THAT(outcome.stop_reason, Catch::Contains("0.6 s after the pose"));
  CHECK(bench.device.pulses.size() == 1);
}

TEST_CASE("a rig is identified from pulses between two poses, and the controller is told", "[unit]") {
  control::RigIdentifier identifier = identifier_of_linear_rig();
  Bench bench;
  bench.duration_s = 2.4;
  const double step_m = 1.5 * kLinearGain_m * 3.0;  // 3 A on a rig half as strong again
  for (int i = 0; i < 3; ++i) bench.sensor.push(i * step_m, 0.0);
  bench.sensor.push_invalid("hidden");
  bench.sensor.push(-0.03, 0.0);  // moved by who knows what
  for (int i = 1; i < 5; ++i) bench.sensor.push(-0.03 + i * step_m, 0.0);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.2, 0.0); });
  const auto outcome = bench.run(controller, &identifier);
  REQUIRE(outcome.steps.size() == 9);
  CHECK(outcome.steps[0].drive_gain->log_mean == Approx(0.0).margin(1e-12));
  CHECK_FALSE(outcome.steps[3].drive_gain);
  CHECK(outcome.steps[4].drive_gain->log_mean == outcome.steps[2].drive_gain->log_mean);
  CHECK(outcome.steps[8].drive_gain->log_mean == Approx(std::log(1.5)).margin(0.05));
  CHECK(controller.seen.back().drive_gain->log_sigma < controller.seen.front().drive_gain->log_sigma);
}

TEST_CASE("the controller is told of a flow that carries the needle besides", "[unit]") {
  control::RigIdentifier identifier = identifier_of_linear_rig();
  Bench bench;
  bench.duration_s = 6.0;
  const double step_m = kLinearGain_m * 3.0;  // 3 A, to and fro
  for (int i = 0; i < 25; ++i) bench.sensor.push(i % 2 == 0 ? 0.0 : step_m, 1e-3 * i);
  int asked = 0;
  tests::FunctionController controller(
      [&asked](const task::Observation&) { return Vector2(asked++ % 2 == 0 ? 0.2 : -0.2, 0.0); });
  REQUIRE(bench.run(controller, &identifier).completed);
  CHECK(controller.seen.front().drift_m.empty());
  REQUIRE_FALSE(controller.seen.back().drift_m.empty());
  const Vector2& drift_m = controller.seen.back().drift_m.front();
  CHECK(std::hypot(drift_m.x(), drift_m.y() - 1e-3) < 0.25e-3);
}

TEST_CASE("any thread may end a run in the middle of its rest, while others watch the coils") {
  const auto table = rig::VirtualRig(rig::VirtualRigConfig{}, 1).fields();
  for (int round = 0; round < 20; ++round) {
    rig::VirtualRig rig(rig::VirtualRigConfig{}, 1, table);
    EndlessClock clock;
    tests::ScriptedSensor sensor(clock);
    sensor.push(0.0, 0.0);
    safety::Supervisor coils(rig.coils(), safety::SafetyConfig{}, rig.config(), clock);
    control::ControlLoop loop({}, tests::paper_action(), coils, sensor, clock);
    tests::FunctionController controller([](const task::Observation&) { return Vector2(0.5, 0.0); });
    control::PointReference reference({0.01, 0.0}, 1.5);
    std::atomic<int> steps{0};
    control::LoopOutcome outcome;
    std::thread driver(
        [&] { outcome = loop.run(controller, reference, [&](const control::StepRecord&) { ++steps; }); });
    while (steps == 0) coils.status();
    loop.interrupt("the operator at the window");
    driver.join();
    CHECK_FALSE(outcome.completed);
    CHECK(outcome.stop_reason == "the operator at the window");
    CHECK(outcome.steps.size() == 1);
    rig.clock().sleep_until(0.2);
    CHECK(std::abs(rig.coils().status().current_A[0]) < 0.2);
  }
}

TEST_CASE("a run that is ended in the middle of a pulse says that it was cut short") {
  class HalfRested final : public common::Clock {
   public:
    double now_s() const override { return now_s_; }
    bool wait_until(double time_s, common::Interruption* interruption) override {
      if (at_rest) at_rest();
      now_s_ += 0.5 * (time_s - now_s_);
      return interruption == nullptr || !interruption->raised();
    }
    std::function<void()> at_rest;

   private:
    double now_s_ = 100.0;
  } clock;
  tests::RecordingCoils device;
  tests::ScriptedSensor sensor(clock);
  sensor.push(0.0, 0.0);
  safety::Supervisor coils(device, safety::SafetyConfig{}, tests::paper_rig(), clock);
  control::ControlLoopConfig config;
  config.pulse_s = 1.0;
  control::ControlLoop loop(config, tests::paper_action(), coils, sensor, clock);
  clock.at_rest = [&] { loop.interrupt("let go"); };
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.5, 0.0); });
  control::PointReference reference({0.01, 0.0}, 1.5);
  CHECK(loop.run(controller, reference).stop_reason == "let go");
  CHECK(sensor.pulses == 1);
  CHECK(sensor.cut == 1);
}

TEST_CASE("a pulse that was over before the run was stopped is none that was cut short") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  tests::FunctionController controller([decided = 0](const task::Observation&) mutable {
    if (++decided == 3) throw common::HardwareError("no third decision");
    return Vector2(0.5, 0.0);
  });
  CHECK_FALSE(bench.run(controller).completed);
  CHECK(bench.sensor.pulses == 2);
  CHECK(bench.sensor.cut == 0);
}

TEST_CASE("a sensor that fails is a fault of the rig: nobody drives on after it") {
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  bench.sensor.throws = true;
  safety::Supervisor coils(bench.device, bench.safety, tests::paper_rig(), bench.clock);
  control::ControlLoop loop(bench.config, bench.action, coils, bench.sensor, bench.clock);
  control::PointReference reference({0.01, 0.0}, bench.duration_s);
  tests::FunctionController controller([](const task::Observation&) { return Vector2(0.5, 0.0); });
  CHECK_THAT(loop.run(controller, reference).stop_reason, Catch::Contains("camera unplugged"));
  CHECK(coils.latched());
  bench.sensor.throws = false;
  CHECK_THAT(loop.run(controller, reference).stop_reason, Catch::Contains("stopped earlier"));
  CHECK(bench.device.pulses.empty());
}

TEST_CASE("in real time, and only then, the loop goes before others where it may") {
  const auto policy = [] { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; };
  int may = SCHED_OTHER;
  {
    const common::RealtimeThread realtime;
    may = policy();
  }
  Bench bench;
  bench.sensor.push(0.0, 0.0);
  int seen = -1;
  tests::FunctionController controller([&](const task::Observation&) {
    seen = policy();
    return Vector2(0.1, 0.0);
  });
  REQUIRE(bench.run(controller).completed);
  CHECK(seen == SCHED_OTHER);
  common::SteadyClock wall;
  safety::Supervisor coils(bench.device, bench.safety, tests::paper_rig(), wall);
  tests::ScriptedSensor sensor{wall};
  sensor.push(0.0, 0.0);
  control::PointReference reference({0.01, 0.0}, 0.3);
  control::ControlLoop(bench.config, bench.action, coils, sensor, wall).run(controller, reference);
  CHECK(seen == may);
  CHECK(policy() == SCHED_OTHER);
}
