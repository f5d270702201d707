// A controller of your own: a pull that grows with the distance takes the needle of a virtual rig to the dish
// centre.
//
//   build/examples/own_controller models/segmenter
//
// The folder is of the network that sees the needle; without it the sensor is simulated. A bench on a serial
// port is opened by session::make_bench_session, and the rest stays as it is.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "lodestone/control/control_loop.h"
#include "lodestone/session/rig_session.h"

using namespace lodestone;

class ProportionalPull final : public control::Controller {
 public:
  void reset() override {}  // it remembers nothing
  geometry::Drive act(const task::Observation& observation) override {
    const geometry::Vector2 way_m = observation.target_m - observation.pose.position_m();
    const double distance_m = way_m.norm();
    if (distance_m < kNear_m) return observation.rest();
    return way_m / distance_m * std::min(1.0, kBreakaway + kGain_per_m * distance_m);
  }
  std::unique_ptr<Controller> clone() const override { return std::make_unique<ProportionalPull>(*this); }

 private:
  static constexpr double kNear_m = 0.001;   // closer there is no pull
  static constexpr double kBreakaway = 0.3;  // of the largest current: what friction takes
  static constexpr double kGain_per_m = 19.0;
};

int main(int count, char** words) try {
  session::SensingConfig sensing;
  if (count > 1)
    sensing.segmenter = words[1];
  else
    sensing.kind = "simulated";
  const rig::VirtualRigConfig rig;
  const auto bench = session::make_virtual_session(rig, sensing, {}, {});
  bench->place({0.015, -0.020, 0.5});

  ProportionalPull controller;
  control::PointReference centre({0.0, 0.0}, 12.0);
  task::ActionConfig action;
  action.scale = rig.coils.max_current_A;  // that an action of 1 means
  control::ControlLoop loop({}, action, bench->coils(), bench->sensor(), bench->clock());
  const control::LoopOutcome outcome = loop.run(controller, centre, [](const control::StepRecord& step) {
    std::printf("%.1f s: %.2f mm off the centre\n", step.time_s,
                1e3 * step.estimate.pose.position_m().norm());
  });
  if (!outcome.completed) throw common::Error("the run was stopped: " + outcome.stop_reason);
} catch (const common::Error& error) {
  std::fprintf(stderr, "own_controller: %s\n", error.what());
  return 1;
}
