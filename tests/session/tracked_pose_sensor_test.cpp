#include "lodestone/session/tracked_pose_sensor.h"

#include <catch2/catch.hpp>
#include <deque>
#include <vector>

#include "control/fakes.h"

using namespace lodestone;

namespace {

vision::Rod rod(const geometry::Pose2& pose, double tape = 10.0) {
  vision::Rod rod;
  rod.found = rod.axis_found = true;
  rod.pose = pose;
  rod.tape_log_odds = tape;
  rod.covariance.diagonal() << 5e-9, 5e-9, 7e-6;
  return rod;
}

/// Shows what a test tells it to; the last for ever.
class Scripted final : public session::NeedleDetector {
 public:
  vision::Sighting look() override {
    ++looks;
    vision::Sighting next = script.front();
    if (script.size() > 1) script.pop_front();
    return next;
  }
  void expect(const geometry::Vector2&) override { ++expected; }
  void search() override { ++searched; }
  void reset() override { ++resets; }
  std::deque<vision::Sighting> script;
  int looks = 0, expected = 0, searched = 0, resets = 0;
};

}  // namespace

TEST_CASE("a first image is looked at twice, and one that leaves no doubt once") {
  Scripted detector;
  detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""}};
  tests::ManualClock clock;
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  CHECK(sensor.observe().valid);
  CHECK(detector.looks == 2);
  CHECK(sensor.observe().valid);
  CHECK(detector.looks == 3);
  CHECK(detector.searched == 0);
}

TEST_CASE("an image without a needle is followed by another one, which is searched as a whole") {
  Scripted detector;
  detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""},
                     {1.0, {rod({0.01, 0.0, 0.5})}, ""},
                     {2.0, {}, "a reflection"},
                     {3.0, {rod({0.01, 0.0, 0.5})}, ""}};
  tests::ManualClock clock;
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  sensor.observe();
  const control::PoseEstimate seen = sensor.observe();
  CHECK(seen.valid);
  CHECK(seen.stamp_s == 3.0);
  CHECK(detector.searched == 1);
  detector.looks = 0;
  detector.script = {{4.0, {}, "a reflection"}};
  const control::PoseEstimate none = sensor.observe();
  CHECK_FALSE(none.valid);
  CHECK(none.reason == "a reflection");
  CHECK(detector.looks == 3);
}

TEST_CASE(
    "of two things the one is taken that lies where the needle lay, and the next image searched there") {
  Scripted detector;
  detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""},
                     {1.0, {rod({0.01, 0.0, 0.5})}, ""},
                     {2.0, {rod({-0.02, 0.01, 1.5}), rod({0.01, 0.0, 0.5})}, ""}};
  tests::ManualClock clock;
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  sensor.observe();
  const control::PoseEstimate seen = sensor.observe();
  CHECK(seen.valid);
  CHECK(seen.pose.x_m == Approx(0.01));
  CHECK(detector.expected == 1);
}

TEST_CASE("a needle that was placed elsewhere is not expected where it was") {
  Scripted detector;
  detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""}};
  tests::ManualClock clock;
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  sensor.observe();
  sensor.forget();
  CHECK(detector.resets == 1);
  detector.script = {{1.0, {rod({-0.03, 0.0, -2.5})}, ""}};
  CHECK(sensor.observe().valid);
}

TEST_CASE(
    "it does not look again where that would make the pulse late, but takes its time for a new needle") {
  for (const auto& [look_s, looks] : {std::pair(0.045, 2), {0.02, 3}}) {
    tests::ManualClock clock;
    Scripted detector;
    detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""}};
    session::TrackedPoseSensor sensor(detector, {}, {}, clock,
                                      [&, wait_s = look_s] { clock.sleep_until(clock.now_s() + wait_s); });
    CHECK(sensor.observe().valid);
    CHECK(detector.looks == 2);
    sensor.observe();
    detector.looks = 0;
    // Something far away, which three looks would have to show.
    detector.script = {{1.0, {rod({-0.02, 0.0, 0.5})}, ""}};
    const double start_s = clock.now_s();
    sensor.observe();
    CHECK(detector.looks <= looks);
    CHECK(clock.now_s() <= start_s + 0.1);
  }
}

TEST_CASE("before a run begins it gets to know a needle, once") {
  tests::ManualClock clock;
  Scripted detector;
  detector.script = {{1.0, {rod({0.01, 0.0, 0.5})}, ""}};
  session::TrackedPoseSensor sensor(detector, {}, {}, clock);
  sensor.acquire();
  CHECK(detector.looks == 2);
  sensor.acquire();
  CHECK(detector.looks == 2);
  CHECK(sensor.observe().valid);
  CHECK(detector.looks == 3);
}
