#include "lodestone/rl/proposals.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "lodestone/inference/actor_critic.h"

using lodestone::geometry::Vector2;
using lodestone::inference::Actor;
using lodestone::rl::imitate;

namespace {

constexpr std::int64_t kProposals = 3;
constexpr std::size_t kNumbers = 4 * kProposals + 1;

/// Proposals to the right, up and to the left, of middling strength.
std::vector<float> three_ways() {
  return {1.0F, 0.0F, -1.0F, 0.0F, 1.0F, -1.0F, -1.0F, 0.0F, -1.0F, 0.0F, 0.0F, 0.0F, 0.0F};
}

}  // namespace

TEST_CASE("The gradient of an imitation is that of its loss", "[unit]") {
  const Vector2 action(0.3, 0.5);
  const std::vector<float> output = {0.9F, 0.2F,  -1.2F, 0.4F, 1.1F,  0.3F, -1.0F,
                                     0.1F, -1.0F, 0.2F,  0.5F, -0.3F, 0.1F};
  std::vector<float> gradient(kNumbers), ignored(kNumbers);
  imitate(output.data(), kProposals, action, 1.0, gradient.data());
  // Of the nearest proposal (the second), and of the scores: the others only follow a little.
  for (const std::size_t number : {3, 4, 5, 9, 10, 11, 12}) {
    constexpr float kStep = 1e-3F;
    std::vector<float> more = output, less = output;
    more[number] += kStep;
    less[number] -= kStep;
    const double slope = (imitate(more.data(), kProposals, action, 1.0, ignored.data()) -
                          imitate(less.data(), kProposals, action, 1.0, ignored.data())) /
                         (2.0 * static_cast<double>(kStep));
    CHECK(static_cast<double>(gradient[number]) == Approx(slope).epsilon(0.02).margin(0.01));
  }
}

TEST_CASE("Of two ways each gets a proposal, and resting is learned as resting", "[unit]") {
  std::vector<float> output = three_ways();
  std::vector<float> gradient(kNumbers);
  const Vector2 right(0.6, -0.1), left(-0.2, 0.05);
  for (int step = 0; step < 4000; ++step) {
    imitate(output.data(), kProposals, step % 2 == 0 ? right : left, 0.01, gradient.data());
    for (std::size_t k = 0; k < kNumbers; ++k) output[k] -= gradient[k];
  }
  float action[2];
  Actor::propose(output.data(), 0, action);
  CHECK((Vector2(action[0], action[1]) - right).norm() < 0.05);
  Actor::propose(output.data(), 2, action);
  CHECK((Vector2(action[0], action[1]) - left).norm() < 0.05);
  for (int step = 0; step < 4000; ++step) {
    imitate(output.data(), kProposals, Vector2::Zero(), 0.01, gradient.data());
    for (std::size_t k = 0; k < kNumbers; ++k) output[k] -= gradient[k];
  }
  CHECK(Actor::choose(output.data(), kProposals) == kProposals);
}
