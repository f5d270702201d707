#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "env/linear_model.h"
#include "lodestone/experiments/deployment.h"

namespace lodestone::tests {

/// Pushes 1 mm along the heading that is wanted while the target is ahead, and a tenth of that to the left.
class Oblique final : public control::Controller {
 public:
  void reset() override {}
  geometry::Drive act(const task::Observation& observation) override {
    const double heading_rad = observation.target_heading_rad.value();
    const geometry::Vector2 ahead(std::cos(heading_rad), std::sin(heading_rad));
    const geometry::Vector2 off_m = observation.target_after_m(1) - observation.pose.position_m();
    if (off_m.dot(ahead) <= 0.0) return observation.rest();
    return geometry::Vector2(0.1 * (ahead + 0.1 * geometry::Vector2(-ahead.y(), ahead.x())));
  }
  std::unique_ptr<Controller> clone() const override { return std::make_unique<Oblique>(*this); }
};

/// What drives so, and rehearses where 1 A moves a needle by 1 mm.
inline experiments::ControllerSource oblique() {
  experiments::SimulatorSource simulator;
  simulator.simulator = std::make_shared<const control::LearnedSimulator>(
      env::tests::linear_model(data::StateLayout::kPose, {1e-3}, {0.0}));
  simulator.action = simulator.simulator->action;
  experiments::ControllerSource source;
  source.name = "oblique";
  source.action = simulator.action;
  source.make = [](std::uint64_t) { return std::make_unique<Oblique>(); };
  source.rehearses_in = std::make_shared<const experiments::SimulatorSource>(simulator);
  return source;
}

}  // namespace lodestone::tests
