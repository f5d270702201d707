#pragma once

#include <catch2/catch.hpp>

#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"

namespace lodestone::tests {

/// What every Controller must keep: actions within [-1, 1]^2 wherever the needle is, and clones that do what
/// it does.
inline void check_controller(control::Controller& controller) {
  common::RandomStream random(11, "conformance");
  for (int episode = 0; episode < 5; ++episode) {
    controller.reset();
    task::Observation observation;
    for (int step = 0; step < 40; ++step) {
      observation.pose = {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03),
                          random.uniform(-3.1, 3.1)};
      observation.target_m = {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03)};
      observation.last_displacement_m = {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01)};
      const std::unique_ptr<control::Controller> clone = controller.clone();
      const geometry::Vector2 expected = clone ? clone->act(observation) : geometry::Vector2::Zero();
      const geometry::Vector2 action = controller.act(observation);
      CHECK((!clone || action == expected));
      CHECK(action.allFinite());
      CHECK(action.cwiseAbs().maxCoeff() <= 1.0 + 1e-12);
      observation.last_action = action;
    }
  }
}

}  // namespace lodestone::tests
