#include "lodestone/session/rig_session.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "control/fakes.h"
#include "lodestone/control/control_loop.h"
#include "paper_rig.h"
#include "session/ground_truth_conformance.h"
#include "session/operator_conformance.h"

using namespace lodestone;

namespace {

session::SensingConfig sensing(const std::string& kind) {
  session::SensingConfig config;
  config.kind = kind;
  config.segmenter = std::string(LODESTONE_SOURCE_DIR) + "/models/segmenter";
  config.camera.timeout_s = 60.0;  // the machine may be busy
  return config;
}

}  // namespace

TEST_CASE("placing the needle goes with the coils off, and the sensor forgets") {
  tests::RecordingCoils device;
  device.state.temperature_C.assign(4, 22.0);
  tests::ManualClock clock;
  safety::Supervisor coils(device, {}, physics::RigDescription{}, clock, safety::Supervisor::Poses::kNone);
  tests::FakeOperator needle_operator;
  bool on_meanwhile = true;
  needle_operator.at_work = [&] { on_meanwhile = device.on; };
  tests::ScriptedSensor sensor(clock);
  session::RigSession::Parts parts;
  parts.sensor = &sensor;
  parts.coils = &coils;
  parts.clock = &clock;
  parts.needle_operator = &needle_operator;
  session::RigSession bench(parts);
  coils.apply({{1.0, 0.0, 0.0, 0.0}, 0.1});
  REQUIRE(device.on);
  bench.place({0.01, 0.02, 0.5});
  CHECK_FALSE(on_meanwhile);
  CHECK(needle_operator.placed.y_m == 0.02);
  CHECK(sensor.forgotten == 1);
  CHECK(bench.truth() == nullptr);
  CHECK(bench.latest_image() == nullptr);
}

TEST_CASE("a virtual session knows the truth, and can be put back") {
  tests::FakeGroundTruth fake;
  tests::check_ground_truth(fake, [&] { ++fake.steps; });
  const auto bench = session::make_virtual_session({}, sensing("simulated"), {}, {});
  REQUIRE(bench->truth() != nullptr);
  const auto drive = [&] {
    bench->place({0.01, 0.0, 0.0});
    bench->coils().observe(bench->sensor().observe());
    bench->coils().apply({{6.0, 0.0, 0.0, 0.0}, 0.1});
    bench->clock().sleep_until(bench->clock().now_s() + 0.3);
  };
  tests::check_ground_truth(*bench->truth(), drive);
  CHECK(bench->fits({0.0, 0.0, 0.0}));
  CHECK_FALSE(bench->fits({0.04, 0.0, 0.0}));
}

// The rig in real time: the loop drives, one thread watches images and coils, and then ends the run.
TEST_CASE("a rig may be watched while the loop drives it, and stopped from there") {
  const auto bench = session::make_virtual_session({}, sensing("camera"), {}, {}, true);
  tests::FunctionController controller([](const task::Observation&) { return geometry::Vector2(0.3, 0.0); });
  control::PointReference reference({0.01, 0.0}, 1e6);
  control::ControlLoop loop({}, tests::paper_action(), bench->coils(), bench->sensor(), bench->clock());
  std::atomic<int> steps{0};
  std::atomic<bool> ended{false};
  control::LoopOutcome outcome;
  std::thread driver([&] {
    outcome = loop.run(controller, reference, [&](const control::StepRecord&) { ++steps; });
    ended = true;
  });
  int images = 0;
  double last_s = -1.0;
  while (steps < 3 && !ended) {
    bench->coils().status();
    const auto image = bench->latest_image();
    if (image && image->stamp_s > last_s) {
      last_s = image->stamp_s;
      CHECK_FALSE(image->image.empty());
      ++images;
    }
    std::this_thread::yield();
  }
  loop.interrupt("seen enough");
  driver.join();
  CHECK(outcome.stop_reason == "seen enough");
  CHECK(images > 0);
}
