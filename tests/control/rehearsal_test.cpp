#include "lodestone/control/rehearsal.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

using namespace lodestone;
using control::Passed;
using geometry::Pose2;
using geometry::Stitch;
using geometry::Vector2;

namespace {

constexpr double kForward_m = 0.001;  // by the strongest pulse
constexpr double kPeriod_s = 0.3;

/// A needle that the second number of the drive turns, by 1 rad at most, and the first one pushes along its
/// heading then, and aside: to the left, the more the further. Luck scatters it.
class DriftingNeedle final : public control::Foresight {
 public:
  DriftingNeedle(double aside, double luck_m, std::size_t state_size = 3) : aside_(aside), luck_m_(luck_m) {
    facts_.action.scale = 2.0;
    facts_.state_size = state_size;
    facts_.dish_radius_m = 0.04;
    facts_.by_chance = luck_m > 0.0;
  }
  const Facts& facts() const override { return facts_; }
  void foresee(std::size_t, std::size_t, const double* state, const double* drive, std::int64_t,
               common::RandomStream& random, double* next) override {
    strongest_ = std::max({strongest_, std::abs(drive[0]), std::abs(drive[1])});
    const double forward_m = kForward_m * drive[0] / facts_.action.scale;
    next[2] = state[2] + drive[1] / facts_.action.scale;
    const Vector2 ahead(std::cos(next[2]), std::sin(next[2]));
    const Vector2 left(-ahead.y(), ahead.x());
    const double left_m = aside_ * forward_m + luck_m_ * random.normal();
    const Vector2 to_m = Vector2(state[0], state[1]) + forward_m * ahead + left_m * left;
    next[0] = to_m.x();
    next[1] = to_m.y();
    ++pulses_;
  }
  int pulses() const { return pulses_; }
  double strongest() const { return strongest_; }
  std::shared_ptr<Foresight> clone() const override { return std::make_shared<DriftingNeedle>(*this); }

 private:
  Facts facts_;
  double aside_, luck_m_;
  int pulses_ = 0;
  double strongest_ = 0.0;  // drive
};

/// Pushes along the heading that is wanted next.
class Turner final : public control::Controller {
 public:
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    const double off_rad =
        geometry::wrap_angle(observation.target_heading_after_rad(1).value() - observation.pose.heading_rad);
    return Vector2(observation.ahead.empty() ? 0.0 : 0.6, off_rad);  // as fast as the target
  }
  std::unique_ptr<Controller> clone() const override { return std::make_unique<Turner>(*this); }
};

/// Pushes while the target is ahead of the needle.
class Pusher final : public control::Controller {
 public:
  explicit Pusher(double strength) : strength_(strength) {}
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    const double heading_rad = observation.pose.heading_rad;
    const Vector2 off_m = observation.target_after_m(1) - observation.pose.position_m();
    const bool ahead = off_m.dot(Vector2(std::cos(heading_rad), std::sin(heading_rad))) > 0.0;
    return Vector2(ahead ? strength_ : 0.0, 0.0);
  }
  std::unique_ptr<Controller> clone() const override { return std::make_unique<Pusher>(*this); }

 private:
  double strength_;
};

/// A controller in ampere, in a simulator of twice as large numbers.
control::Rehearsal in(control::Controller& pusher, control::Foresight& needle) {
  control::Rehearsal with{pusher, {}, needle, 2.0, kPeriod_s};
  with.action.scale = 1.0;
  return with;
}

/// To the left of how it lies, mm.
double left_mm(const Pose2& aim, const Pose2& end) {
  const Vector2 left(-std::sin(end.heading_rad), std::cos(end.heading_rad));
  return 1e3 * left.dot(aim.position_m() - end.position_m());
}

}  // namespace

TEST_CASE("a needle that drifts aside on its push is led to half of that on the other side of the entry") {
  DriftingNeedle needle(0.1, 0.0);
  Pusher pusher(1.0);
  const std::vector<Stitch> stitches = geometry::running_stitch(2, 0.006, 0.004);
  const std::vector<Stitch> aims = control::rehearsed(stitches, {}, in(pusher, needle), 1);
  REQUIRE(aims.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {  // 0.6 mm over 6, up and down
    CHECK(left_mm(aims[i].entry, stitches[i].entry) == Approx(-0.3).margin(1e-6));
    CHECK(left_mm(aims[i].exit, stitches[i].exit) == Approx(0.3).margin(1e-6));
    CHECK(aims[i].entry.heading_rad == stitches[i].entry.heading_rad);
  }
}

TEST_CASE("an approach on which the needle drifts, too, is made up for as well") {
  DriftingNeedle needle(0.1, 0.0);
  Pusher pusher(1.0);
  control::SutureReferenceConfig config;
  config.approach_m = 0.002;
  const std::vector<Stitch> stitch = geometry::running_stitch(1, 0.006, 0.0);
  const auto passed = control::rehearse(stitch[0], config, in(pusher, needle), 1, 0);
  REQUIRE(passed);
  CHECK(1e3 * passed->entry_m == Approx(0.2).margin(1e-6));
  CHECK(1e3 * passed->exit_m == Approx(0.8).margin(1e-6));
  const std::vector<Stitch> aims = control::rehearsed(stitch, config, in(pusher, needle), 1);
  CHECK(left_mm(aims[0].entry, stitch[0].entry) == Approx(-0.5).margin(1e-6));  // the way begins there
  CHECK(left_mm(aims[0].exit, stitch[0].exit) == Approx(0.3).margin(1e-6));
  const auto again = control::rehearse(aims[0], config, in(pusher, needle), 1, 0);
  REQUIRE(again);  // 0.3 mm beside both: 0.2 to the left of the entry that is aimed at, 0.5 to the left of
                   // the exit
  CHECK(1e3 * again->entry_m - 0.5 == Approx(-0.3).margin(1e-6));
  CHECK(1e3 * again->exit_m + 0.3 == Approx(0.3).margin(1e-6));
}

TEST_CASE("through a stitch that bends back the exit is passed where the needle comes out") {
  DriftingNeedle needle(0.0, 0.0);
  Turner turner;
  const Stitch arch{{-0.003, 0.0, 0.5 * geometry::kPi}, {0.003, 0.0, -0.5 * geometry::kPi}};
  control::SutureReferenceConfig config;
  config.approach_m = 0.002;  // then it begins beyond the line across the exit, 6 mm beside it
  const auto passed = control::rehearse(arch, config, in(turner, needle), 1, 0);
  REQUIRE(passed);
  CHECK(std::abs(passed->exit_m) < 0.0015);
}

TEST_CASE("no end is passed by further beside it than is allowed") {
  DriftingNeedle needle(0.5, 0.0);
  Pusher pusher(1.0);
  const std::vector<Stitch> stitch = geometry::running_stitch(1, 0.006, 0.0);
  const std::vector<Stitch> aims = control::rehearsed(stitch, {}, in(pusher, needle), 1);
  CHECK(left_mm(aims[0].entry, stitch[0].entry) == Approx(-0.5).margin(1e-6));
  CHECK(left_mm(aims[0].exit, stitch[0].exit) == Approx(0.5).margin(1e-6));
}

TEST_CASE("a stitch that a rehearsal never comes through is aimed at as it is") {
  DriftingNeedle needle(0.1, 0.0);
  Pusher weak(0.1);  // 0.1 mm a pulse: the target is far ahead when it is at its end
  const std::vector<Stitch> stitch = geometry::running_stitch(1, 0.006, 0.0);
  CHECK_FALSE(control::rehearse(stitch[0], {}, in(weak, needle), 1, 0));
  const std::vector<Stitch> aims = control::rehearsed(stitch, {}, in(weak, needle), 1);
  CHECK(left_mm(aims[0].entry, stitch[0].entry) == 0.0);
  CHECK(left_mm(aims[0].exit, stitch[0].exit) == 0.0);
}

TEST_CASE("rehearsals differ by their luck, and are the same for the same seed") {
  DriftingNeedle needle(0.1, 1e-4);
  Pusher pusher(1.0);
  const std::vector<Stitch> stitch = geometry::running_stitch(1, 0.006, 0.0);
  const auto exit_m = [&](std::uint64_t seed, std::uint64_t turn) {
    return control::rehearse(stitch[0], {}, in(pusher, needle), seed, turn)->exit_m;
  };
  CHECK(exit_m(1, 0) == exit_m(1, 0));
  CHECK(exit_m(1, 0) != exit_m(1, 1));
  CHECK(exit_m(1, 0) != exit_m(2, 0));
  control::SutureReferenceConfig many;
  many.rehearsals = 200;
  const std::vector<Stitch> aims = control::rehearsed(stitch, many, in(pusher, needle), 1);
  CHECK(left_mm(aims[0].entry, stitch[0].entry) == Approx(-0.3).margin(0.05));  // of the mean
}

TEST_CASE("a simulator that knows no headings is none to rehearse in") {
  DriftingNeedle sphere(0.1, 0.0, 2);
  Pusher pusher(1.0);
  CHECK_THROWS_AS(control::rehearsed(geometry::running_stitch(1, 0.006, 0.0), {}, in(pusher, sphere), 1),
                  common::LogicFault);
}

TEST_CASE("the simulator is asked about no pulse without current, and none beyond its largest") {
  DriftingNeedle needle(0.0, 0.0);
  Pusher pusher(1.0);
  control::Rehearsal with = in(pusher, needle);
  with.drive_per_A = 6.0;  // it was shown a third of what the controller may give
  REQUIRE(control::rehearse(geometry::running_stitch(1, 0.006, 0.0)[0], {}, with, 1, 0));
  CHECK(needle.strongest() == 2.0);
  const int pulses = needle.pulses();
  Pusher idle(0.0);
  CHECK_FALSE(control::rehearse(geometry::running_stitch(1, 0.006, 0.0)[0], {}, in(idle, needle), 1, 0));
  CHECK(needle.pulses() == pulses);
}
