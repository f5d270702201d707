#include "lodestone/control/policy_controller.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "control/controller_conformance.h"
#include "inference/random_policy.h"
#include "paper_rig.h"

using namespace lodestone;
using geometry::Vector2;

namespace {

inference::Policy small_policy() {
  inference::Policy policy;
  policy.encoder = tests::paper_encoder();
  policy.action = tests::paper_action();
  policy.encoder.memory = true;
  policy.hidden = {16, 16};
  tests::draw_weights(policy, 4);
  return policy;
}

}  // namespace

TEST_CASE("a policy keeps the contract of controllers") {
  control::PolicyController controller(small_policy());
  tests::check_controller(controller);
}

TEST_CASE("the policy controller computes what the network computes") {
  const inference::Policy policy = small_policy();
  control::PolicyController controller(policy);
  task::Observation observation;
  observation.pose = {0.02, 0.0, 0.4};
  observation.last_action = {0.2, -0.1};
  observation.last_displacement_m = {0.001, 0.0};
  const task::ObservationEncoder encoder(policy.encoder);
  std::vector<float> input(static_cast<std::size_t>(encoder.size()));
  encoder.encode(observation, input.data());
  float expected[2];
  inference::Actor::Workspace workspace;
  policy.actor().act(input.data(), 1, expected, workspace);
  const Vector2 action = controller.act(observation);
  CHECK(action.x() == expected[0]);
  CHECK(action.y() == expected[1]);
}
