#include "lodestone/rl/proposals.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "lodestone/inference/actor_critic.h"

using lodestone::geometry::Drive;
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
  const auto check = [](const Drive& action, const std::vector<float>& output,
                        const std::vector<std::size_t>& numbers) {
    std::vector<float> gradient(output.size()), ignored(output.size());
    imitate(output.data(), kProposals, action, 1.0, gradient.data());
    for (const std::size_t number : numbers) {
      constexpr float kStep = 1e-3F;
      std::vector<float> more = output, less = output;
      more[number] += kStep;
      less[number] -= kStep;
      const double slope = (imitate(more.data(), kProposals, action, 1.0, ignored.data()) -
                            imitate(less.data(), kProposals, action, 1.0, ignored.data())) /
                           (2.0 * static_cast<double>(kStep));
      CAPTURE(action.transpose(), number);
      CHECK(static_cast<double>(gradient[number]) == Approx(slope).epsilon(0.02).margin(0.01));
    }
  };
  // Of the nearest proposal (the second), and of the scores: the others only follow a little.
  check({0.3, 0.5}, {0.9F, 0.2F, -1.2F, 0.4F, 1.1F, 0.3F, -1.0F, 0.1F, -1.0F, 0.2F, 0.5F, -0.3F, 0.1F},
        {3, 4, 5, 9, 10, 11, 12});
  check({0.3, 0.5, -0.2},
        {0.9F, 0.2F, 0.1F, -1.2F, 0.4F, 1.1F, -0.3F, 0.3F, -1.0F, 0.1F, 0.8F, -1.0F, 0.2F, 0.5F, -0.3F, 0.1F},
        {4, 5, 6, 7, 12, 13, 14, 15});
}

TEST_CASE("A proposal learns an action of any number of numbers", "[unit]") {
  const Drive action{0.5, 0.0, -0.3, 0.1};
  std::vector<float> output(static_cast<std::size_t>(Actor::outputs(4, 1)), 0.1F);
  std::vector<float> gradient(output.size());
  for (int step = 0; step < 4000; ++step) {
    imitate(output.data(), 1, action, 0.01, gradient.data());
    for (std::size_t k = 0; k < output.size(); ++k) output[k] -= gradient[k];
  }
  float given[4];
  Actor::propose(output.data(), 4, 0, given);
  CHECK((lodestone::geometry::as_drive(given, 4) - action).norm() < 0.02);
  CHECK(Actor::choose(output.data(), 4, 1) == 0);
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
  Actor::propose(output.data(), 2, 0, action);
  CHECK((Vector2(action[0], action[1]) - right).norm() < 0.05);
  Actor::propose(output.data(), 2, 2, action);
  CHECK((Vector2(action[0], action[1]) - left).norm() < 0.05);
  for (int step = 0; step < 4000; ++step) {
    imitate(output.data(), kProposals, Vector2::Zero(), 0.01, gradient.data());
    for (std::size_t k = 0; k < kNumbers; ++k) output[k] -= gradient[k];
  }
  CHECK(Actor::choose(output.data(), 2, kProposals) == kProposals);
}
