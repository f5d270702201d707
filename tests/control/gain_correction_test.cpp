#include "lodestone/control/gain_correction.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using geometry::Vector2;

namespace {

/// Asks for the same every time, and remembers what it was told.
class Constant final : public control::Controller {
 public:
  explicit Constant(task::Observation& told) : told_(told) {}
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    told_ = observation;
    return {0.4, -0.2};
  }

 private:
  task::Observation& told_;
};

}  // namespace

TEST_CASE("a command is divided by the gain, and the last one is told as the known rig's", "[unit]") {
  task::Observation told;
  control::GainCorrection correction(std::make_unique<Constant>(told));
  task::Observation observation;
  observation.last_action = {0.3, 0.6};
  CHECK(correction.act(observation) == Vector2(0.4, -0.2));
  CHECK(told.last_action == observation.last_action);
  observation.drive_gain = task::DriveGain{std::log(2.0), 0.1};
  CHECK(correction.act(observation).isApprox(Vector2(0.2, -0.1)));
  CHECK(told.last_action.isApprox(Vector2(0.6, 1.0)));
  observation.drive_gain = task::DriveGain{std::log(0.2), 0.1};
  CHECK(correction.act(observation).isApprox(Vector2(1.0, -0.5)));  // as much as there is, in its direction
}
