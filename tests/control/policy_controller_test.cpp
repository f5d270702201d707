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

namespace {

/// Proposes pulses along +x, +y and -x wherever the needle is, liking them in this order, and resting as
/// told.
inference::Policy three_proposals(float rest_score) {
  inference::Policy policy;
  policy.encoder = tests::paper_encoder();
  policy.action = tests::paper_action();
  policy.hidden = {4};
  policy.proposals = 3;
  tests::draw_weights(policy, 4);
  for (auto& [name, weights] : policy.weights)
    weights = {std::vector<float>(weights.size(), 0.0F), weights.shape()};
  inference::Array& bias = policy.weights["l2.bias"];
  bias = {std::vector<float>{1, 0, 0, 0, 1, 0, -1, 0, 0, 3, 2, 1, rest_score}, bias.shape()};
  return policy;
}

}  // namespace

TEST_CASE("a policy gives its next proposal where the better ones have moved nothing") {
  control::PolicyController controller(three_proposals(-5.0F));
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.4};
  const auto give = [&] { return observation.last_action = controller.act(observation); };
  const Vector2 first = give();
  CHECK(first.x() > 0.5);
  CHECK(first.y() == Approx(0.0).margin(1e-6));
  observation.pose.x_m += 1e-4;  // a camera errs
  CHECK(give().y() > 0.5);
  CHECK(give().x() < -0.5);
  CHECK(give() == first);  // nothing is left: from the beginning
  observation.pose.x_m += 0.002;
  CHECK(give() == first);  // another place is another friction
  CHECK(give().y() > 0.5);
  controller.reset();
  CHECK(give() == first);

  control::PolicyController resting(three_proposals(5.0F));
  observation.last_action.setZero();
  CHECK(resting.act(observation).isZero(0.0));
}

TEST_CASE("a pulse that was not the policy's, or seen from nowhere, is no stall of its proposals") {
  control::PolicyController controller(three_proposals(-5.0F));
  task::Observation observation;
  observation.pose = {0.01, 0.0, 0.4};
  const Vector2 first = controller.act(observation);
  observation.last_action.setZero();  // the needle was not seen meanwhile
  CHECK(controller.act(observation) == first);
  observation.last_action = {0.0, -1.0};  // something else was around it
  CHECK(controller.act(observation) == first);
}
