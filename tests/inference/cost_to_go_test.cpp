#include "lodestone/inference/cost_to_go.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using lodestone::geometry::Pose2;
using lodestone::inference::Array;
using lodestone::inference::Arrays;
using lodestone::inference::CostToGo;
using lodestone::inference::PoseCost;

namespace {

PoseCost cost() {
  PoseCost cost;
  cost.dish_radius_m = 0.0425;
  return cost;
}

/// One hidden layer of `width`, drawn; the last bias says what a far pose costs.
Arrays weights(std::int64_t width, float last_bias) {
  lodestone::common::RandomStream random(3, "cost to go");
  const auto drawn = [&random](std::int64_t rows, std::int64_t columns) {
    std::vector<float> numbers(static_cast<std::size_t>(rows * columns));
    for (float& number : numbers) number = static_cast<float>(random.uniform(-0.1, 0.1));
    return Array(std::move(numbers), {rows, columns});
  };
  return {{"l1.weight", drawn(width, CostToGo::kFeatures)},
          {"l1.bias", Array(std::vector<float>(static_cast<std::size_t>(width)), {width})},
          {"l2.weight", drawn(1, width)},
          {"l2.bias", Array(std::vector<float>{last_bias}, {1})}};
}

}  // namespace

TEST_CASE("What a pose costs falls to nothing at the goal, whichever way around the headings lie", "[unit]") {
  const Pose2 goal{0.01, -0.005, 3.1};
  CHECK(cost().at(goal, goal) == 0.0);
  CHECK(cost().at({0.011, -0.005, 3.1}, goal) == Approx(1.0 - std::exp(-1.0)));
  CHECK(
      cost().at({0.01, -0.005, 3.1 + 5.0 * lodestone::geometry::kRadPerDeg - 2.0 * lodestone::geometry::kPi},
                goal) == Approx(1.0 - std::exp(-1.0)));
  CHECK(cost().at({-0.02, 0.01, 0.0}, goal) == Approx(1.0));
  CHECK(cost().most() == Approx(1.0 / (1.0 - cost().discount)));
}

TEST_CASE("A cost-to-go stays within its bounds, and a row is alone with its goal", "[unit]") {
  const CostToGo learned(weights(8, 0.4F), {8}, cost());
  const std::vector<double> state = {0.01, 0.0, 0.2, -0.02, 0.01, 2.0, 0.0, 0.03, -1.0, 0.05, 0.0, 0.0};
  const Pose2 goals[] = {{0.01, 0.0, 0.2}, {-0.01, 0.02, -2.0}};
  CostToGo::Workspace workspace;
  std::vector<double> together(4), alone(4);
  learned.evaluate(state.data(), goals, 2, 4, together.data(), workspace);
  for (std::size_t row = 0; row < 4; ++row) {
    learned.evaluate(&state[3 * row], &goals[row / 2], 1, 1, &alone[row], workspace);
    CHECK(together[row] >= 0.0);
    CHECK(together[row] <= learned.cost().most());
  }
  CHECK(together == alone);
  CHECK(together[3] == learned.cost().most());  // outside the dish
  CHECK(together[0] < together[1]);             // at its goal, where a pulse costs nothing
}

TEST_CASE("A cost-to-go of another shape is refused", "[unit]") {
  CHECK_THROWS_WITH(CostToGo(weights(8, 0.0F), {9}, cost(), "checkpoint x"), Catch::Contains("checkpoint x"));
}
