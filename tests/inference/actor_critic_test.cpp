#include "lodestone/inference/actor_critic.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using inference::Arrays;

namespace {

/// Layers l<first>... with random weights.
void add_layers(Arrays& weights, const std::vector<std::int64_t>& widths, int first) {
  common::RandomStream random(3, "layers", static_cast<std::uint64_t>(first));
  for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
    const std::string name = "l" + std::to_string(first + static_cast<int>(i));
    std::vector<float> weight(static_cast<std::size_t>(widths[i] * widths[i + 1]));
    std::vector<float> bias(static_cast<std::size_t>(widths[i + 1]));
    for (auto* numbers : {&weight, &bias})
      for (float& number : *numbers) number = static_cast<float>(random.uniform(-0.7, 0.7));
    weights[name + ".weight"] = {weight, {widths[i + 1], widths[i]}};
    weights[name + ".bias"] = {bias, {widths[i + 1]}};
  }
}

/// What the layers say, in double and one number at a time.
std::vector<double> reference(const Arrays& weights, int first, int layers, std::vector<double> x) {
  for (int i = 0; i < layers; ++i) {
    const std::string name = "l" + std::to_string(first + i);
    const std::vector<double> weight = weights.at(name + ".weight").to_double();
    std::vector<double> y = weights.at(name + ".bias").to_double();
    for (std::size_t out = 0; out < y.size(); ++out) {
      for (std::size_t in = 0; in < x.size(); ++in) y[out] += weight[out * x.size() + in] * x[in];
      if (i + 1 < layers) y[out] = std::max(0.0, y[out]);
    }
    x = y;
  }
  return x;
}

}  // namespace

TEST_CASE("the actor is its layers, ReLU in between and tanh at the end", "[unit]") {
  Arrays weights;
  add_layers(weights, {5, 20, 9, 2}, 1);
  const inference::Actor actor(weights, 5, {20, 9});
  common::RandomStream random(1, "observations");
  std::vector<float> observation(5 * 33);
  for (float& number : observation) number = static_cast<float>(random.uniform(-1.0, 1.0));
  std::vector<float> action(2 * 33);
  inference::Actor::Workspace workspace;
  actor.act(observation.data(), 33, action.data(), workspace);
  for (std::size_t row = 0; row < 33; ++row) {
    const auto begin = observation.begin() + static_cast<std::ptrdiff_t>(5 * row);
    const std::vector<double> expected = reference(weights, 1, 3, {begin, begin + 5});
    for (std::size_t j = 0; j < 2; ++j)
      CHECK(action[2 * row + j] == Approx(std::tanh(expected[j])).margin(1e-6));
    // A row by itself, in a workspace that was larger: the same bits.
    float alone[2];
    actor.act(&observation[5 * row], 1, alone, workspace);
    CHECK(alone[0] == action[2 * row]);
    CHECK(alone[1] == action[2 * row + 1]);
  }
}

TEST_CASE("the twin critics see observation and action", "[unit]") {
  Arrays weights;
  add_layers(weights, {7, 12, 8, 1}, 1);
  add_layers(weights, {7, 12, 8, 1}, 4);
  const inference::TwinCritic critic(weights, 5, {12, 8});
  const std::vector<float> observation = {0.1F, -0.2F, 0.3F, 0.4F, -0.5F, 0.5F, 0.4F, 0.3F, 0.2F, 0.1F};
  const std::vector<float> action = {0.6F, -0.7F, -1.0F, 1.0F};
  float first[2];
  float second[2];
  inference::TwinCritic::Workspace workspace;
  critic.evaluate(observation.data(), action.data(), 2, first, second, workspace);
  for (std::size_t row = 0; row < 2; ++row) {
    std::vector<double> input(observation.begin() + static_cast<std::ptrdiff_t>(5 * row),
                              observation.begin() + static_cast<std::ptrdiff_t>(5 * row + 5));
    input.insert(input.end(), {action[2 * row], action[2 * row + 1]});
    CHECK(first[row] == Approx(reference(weights, 1, 3, input)[0]).margin(1e-6));
    CHECK(second[row] == Approx(reference(weights, 4, 3, input)[0]).margin(1e-6));
    CHECK(first[row] != second[row]);
  }
}

TEST_CASE("of an actor's proposals the one with the highest score is given, and resting is exactly zero",
          "[unit]") {
  constexpr std::int64_t kProposals = 3;
  const std::int64_t outputs = inference::Actor::outputs(2, kProposals);
  REQUIRE(outputs == 13);
  Arrays weights;
  add_layers(weights, {4, 8, outputs}, 1);
  const inference::Actor actor(weights, 4, {8}, 2, "actor", kProposals);
  CHECK(actor.action_size() == 2);
  common::RandomStream random(9, "observations");
  std::vector<int> given(kProposals + 1);
  inference::Actor::Workspace workspace;
  for (int i = 0; i < 400; ++i) {
    std::vector<float> observation(4);
    for (float& value : observation) value = static_cast<float>(random.uniform(-3.0, 3.0));
    const std::vector<double> row = reference(weights, 1, 2, {observation.begin(), observation.end()});
    const auto best =
        static_cast<std::size_t>(std::max_element(row.begin() + 9, row.end()) - (row.begin() + 9));
    ++given[best];
    float action[2];
    actor.act(observation.data(), 1, action, workspace);
    const auto ranked = actor.ranked(observation.data(), workspace);
    CHECK(ranked.size() == kProposals + 1);
    CHECK(ranked.front() == lodestone::geometry::as_drive(action, 2));
    const auto rests =
        std::count_if(ranked.begin(), ranked.end(), [](const auto& one) { return one.isZero(0.0); });
    CHECK(rests == 1);  // somewhere among them
    if (best == kProposals) {
      CHECK(action[0] == 0.0F);
      CHECK(action[1] == 0.0F);
      continue;
    }
    const double x = row[3 * best];
    const double y = row[3 * best + 1];
    const double strength = std::sqrt(2.0) / (1.0 + std::exp(-row[3 * best + 2]));
    CHECK(action[0] == Approx(std::clamp(strength * x / std::hypot(x, y), -1.0, 1.0)).margin(1e-4));
    CHECK(action[1] == Approx(std::clamp(strength * y / std::hypot(x, y), -1.0, 1.0)).margin(1e-4));
  }
  CHECK(std::count(given.begin(), given.end(), 0) < kProposals);  // more than one has its turn
}

TEST_CASE("weights of another shape are refused by name", "[unit]") {
  Arrays weights;
  add_layers(weights, {5, 20, 9, 2}, 1);
  CHECK_THROWS_WITH(inference::Actor(weights, 6, {20, 9}, 2, "this actor"),
                    Catch::Contains("this actor: array \"l1.weight\" is [20, 5] float32, expected [20, 6]"));
  weights.erase("l2.bias");
  CHECK_THROWS_WITH(inference::Actor(weights, 5, {20, 9}), Catch::Contains("array \"l2.bias\" is missing"));
}
