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
  PoseCost twenty = cost();
  twenty.discount = 0.95;
  CHECK(twenty.most() == Approx(20.0));
}

TEST_CASE("A pose is within a share of the tolerances of a goal by both, the place and the heading",
          "[unit]") {
  const Pose2 goal{0.01, -0.005, 3.1};
  const auto turned = [](double degrees) { return 3.1 + degrees * lodestone::geometry::kRadPerDeg; };
  CHECK(cost().within(0.9, {0.0108, -0.005, turned(4.4)}, goal));
  CHECK_FALSE(cost().within(0.9, {0.0110, -0.005, turned(0.0)}, goal));
  CHECK_FALSE(cost().within(0.9, {0.01, -0.005, turned(-4.6)}, goal));
  CHECK_FALSE(cost().within(0.0, goal, goal));
}

TEST_CASE("Whoever stays pays for it at every pulse to come, and nothing need cost more", "[unit]") {
  PoseCost twenty = cost();
  twenty.discount = 0.95;
  const Pose2 goal{0.01, -0.005, 0.3};
  const Pose2 near{0.0105, -0.005, 0.3};
  CHECK(twenty.of_staying(goal, goal) == 0.0);
  CHECK(twenty.of_staying(near, goal) == Approx(20.0 * twenty.at(near, goal)));
  CHECK(twenty.of_staying({-0.02, 0.01, 0.3}, goal) == Approx(20.0));
  CHECK(twenty.of_staying({0.05, 0.0, 0.3}, {0.05, 0.0, 0.3}) == Approx(20.0));  // outside the dish
  // By one that says everywhere: 8 pulses. So it does far away, but not where staying costs less.
  Arrays eight = weights(8, 0.4F);
  eight.at("l2.weight") = Array(std::vector<float>(8), {1, 8});
  const CostToGo learned(eight, {8}, twenty);
  const double state[] = {near.x_m, near.y_m, near.heading_rad, -0.02, 0.01, 0.3};
  double after[2];
  CostToGo::Workspace workspace;
  learned.evaluate(state, &goal, 2, 2, after, workspace);
  CHECK(after[0] == Approx(twenty.of_staying(near, goal)));
  CHECK(after[1] == Approx(1.0 + 0.95 * 8.0));
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
