#include "lodestone/control/either_way.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "control/fakes.h"
#include "lodestone/control/decorators.h"
#include "lodestone/geometry/angle.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

/// Drives by the heading alone, and counts how often it was asked.
class ByHeading final : public control::Controller {
 public:
  explicit ByHeading(std::function<Vector2(double)> drive) : drive_(std::move(drive)) {}
  void reset() override { asked = 0; }
  geometry::Drive act(const task::Observation& observation) override {
    ++asked;
    return drive_(observation.pose.heading_rad);
  }
  std::unique_ptr<control::Controller> clone() const override { return std::make_unique<ByHeading>(*this); }
  int asked = 0;

 private:
  std::function<Vector2(double)> drive_;
};

Vector2 along(double angle_deg, double size) {
  return size *
         Vector2(std::cos(angle_deg * geometry::kRadPerDeg), std::sin(angle_deg * geometry::kRadPerDeg));
}

/// A controller that asks for these with the head to +x and to -x.
ByHeading asks(const Vector2& ahead, const Vector2& back) {
  return ByHeading([=](double heading_rad) { return std::cos(heading_rad) > 0.0 ? ahead : back; });
}

std::optional<geometry::Drive> act(const control::Controller& controller) {
  return control::act_either_way(controller, {}, tests::paper_action());
}

}  // namespace

TEST_CASE("what is asked for whichever end is the head is given, as weak as it is asked for") {
  CHECK(*act(asks(along(10.0, 0.5), along(35.0, 0.3))) == along(35.0, 0.3));
  CHECK(*act(asks(along(-14.0, 0.2), along(14.0, 0.9))) == along(-14.0, 0.2));
}

TEST_CASE("nothing is given where the two differ by more than 30 degrees, or one of them rests") {
  CHECK_FALSE(act(asks(along(10.0, 0.5), along(42.0, 0.5))));
  CHECK_FALSE(act(asks(along(0.0, 0.5), along(180.0, 0.5))));
  CHECK_FALSE(act(asks(along(0.0, 0.5), Vector2::Zero())));
  CHECK_FALSE(act(asks(Vector2::Zero(), Vector2::Zero())));
}

TEST_CASE("a controller takes no note of being asked either way, nor does one inside it") {
  const ByHeading bare = asks(along(0.0, 0.1), along(5.0, 0.1));
  CHECK(act(bare));
  CHECK(bare.asked == 0);
  control::DecoratorConfig config;
  config.stall_gain = 1.5;
  control::AdaptiveGain around(std::make_unique<ByHeading>(bare), config);
  around.reset();
  task::Observation stalled;
  around.act(stalled);
  stalled.last_action = {0.1, 0.0};
  for (int i = 0; i < 3; ++i) {
    const auto given = control::act_either_way(around, stalled, tests::paper_action());
    REQUIRE(given);
    CHECK(given->norm() == Approx(0.1));  // the other way round it has turned, and not stalled
  }
  CHECK(around.gain() == 1.0);
}

TEST_CASE("a controller that has no clone is not asked, nor is one around it") {
  const auto make = [] {
    return std::make_unique<tests::FunctionController>(
        [](const task::Observation&) { return Vector2(0.5, 0.0); });
  };
  CHECK_FALSE(act(*make()));
  CHECK_FALSE(act(control::Hold(make(), {})));
}
