#include "lodestone/rl/expected_distance.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "env/linear_model.h"

using lodestone::common::RandomStream;
using lodestone::geometry::Vector2;
using lodestone::rl::DistanceCost;
using lodestone::rl::ExpectedDistance;

namespace {

/// A mixture of two whose weights, means and spreads all depend on everything, by a random network.
lodestone::inference::DynamicsModel random_simulator(
    lodestone::inference::Symmetry symmetry = lodestone::inference::Symmetry::kNone,
    bool needle_frame = false) {
  namespace inference = lodestone::inference;
  constexpr auto kLayout = lodestone::data::StateLayout::kPose;
  constexpr std::int64_t kHidden = 12;
  inference::DynamicsModel model = lodestone::env::tests::empty_linear_model(kLayout, 1);
  model.config.hidden = {kHidden};
  model.config.components = 2;
  model.config.symmetry = symmetry;
  model.config.symmetry_exact = !needle_frame;
  model.config.needle_frame = needle_frame;
  const std::int64_t inputs = model.config.inputs(kLayout);
  const std::int64_t outputs = model.config.mixture(kLayout).outputs();
  RandomStream random(7, "random simulator");
  const auto draw = [&](std::vector<std::int64_t> shape, double most) {
    std::int64_t count = 1;
    for (const std::int64_t size : shape) count *= size;
    std::vector<float> values(static_cast<std::size_t>(count));
    for (float& value : values) value = static_cast<float>(random.uniform(-most, most));
    return inference::Array(std::move(values), std::move(shape));
  };
  inference::Arrays weights = lodestone::env::tests::without_normalisation(inputs, 3);
  weights["layers.0.weight"] = draw({kHidden, inputs}, 0.3);
  weights["layers.0.bias"] = draw({kHidden}, 1.0);
  weights["layers.2.weight"] = draw({outputs, kHidden}, 0.5);
  weights["layers.2.bias"] = draw({outputs}, 0.5);
  weights["output_std"] = {std::vector<float>{3e-3F, 2e-3F, 1.0F}, {3}};
  model.members.emplace_back(weights, model.config, kLayout, "random simulator");
  return model;
}

}  // namespace

TEST_CASE("A distance costs nothing less within the goal, and more outside the dish", "[rl]") {
  const DistanceCost cost{0.001, 0.04};
  Vector2 gradient;
  CHECK(cost.at({0.0102, 0.0}, {0.01, 0.0}, &gradient) == Approx(1.0));
  CHECK(gradient.norm() == 0.0);
  CHECK(cost.at({0.01, 0.003}, {0.01, 0.0}, &gradient) == Approx(3.0));
  CHECK(gradient.x() == Approx(0.0).margin(1e-9));
  CHECK(gradient.y() == Approx(1000.0));
  CHECK(cost.at({0.041, 0.0}, {0.039, 0.0}) > 50.0);
}

TEST_CASE("The gradient by the drive is the slope of the expected distance", "[rl]") {
  using lodestone::inference::Symmetry;
  const auto model = random_simulator(GENERATE(Symmetry::kNone, Symmetry::kSquare), GENERATE(false, true));
  const ExpectedDistance expected(model.members.front(), {0.0003, 0.0425});
  constexpr std::int64_t kRows = 64;
  RandomStream random(3, "expected distance");
  std::vector<double> state, drive, target_m;
  for (std::int64_t row = 0; row < kRows; ++row) {
    for (int i = 0; i < 2; ++i) state.push_back(random.uniform(-0.02, 0.02));
    state.push_back(random.uniform(-3.0, 3.0));
    for (int i = 0; i < 2; ++i) drive.push_back(random.uniform(-10.0, 10.0));
    for (int i = 0; i < 2; ++i) target_m.push_back(random.uniform(-0.02, 0.02));
  }
  auto workspace = expected.workspace(kRows);
  std::vector<double> cost_mm(kRows), gradient(2 * kRows), above_mm(kRows), below_mm(kRows);
  constexpr double kStep = 0.02;
  constexpr double kTurn_rad = 0.4;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto shifted = [&](double by, std::vector<double>& out) {
      std::vector<double> other = drive;
      for (std::size_t row = 0; row < kRows; ++row) other[2 * row + axis] += by;
      expected.evaluate(state.data(), other.data(), target_m.data(), kTurn_rad, out.data(), nullptr,
                        workspace);
    };
    shifted(kStep, above_mm);
    shifted(-kStep, below_mm);
    expected.evaluate(state.data(), drive.data(), target_m.data(), kTurn_rad, cost_mm.data(), gradient.data(),
                      workspace);
    int alike = 0;
    double largest = 0.0;
    for (std::size_t row = 0; row < kRows; ++row) {
      const double slope = (above_mm[row] - below_mm[row]) / (2.0 * kStep);
      largest = std::max(largest, std::abs(slope));
      if (std::abs(slope - gradient[2 * row + axis]) < 0.01 + 0.05 * std::abs(slope)) ++alike;
    }
    CHECK(largest > 0.1);
    CHECK(alike >= kRows - 4);  // a few rows sit on a kink of the network within the step
  }
}

TEST_CASE("Its outcomes are on average as far from the target as it expects", "[rl]") {
  const auto model = random_simulator();
  const DistanceCost cost{0.0003, 0.0425};
  const ExpectedDistance expected(model.members.front(), cost);
  auto workspace = expected.workspace(1);
  const double state[3] = {0.01, -0.005, 1.0};
  const double drive[2] = {6.0, -3.0};
  const double target_m[2] = {0.015, 0.0};
  RandomStream random(4, "outcomes");
  double expected_mm = 0.0;
  constexpr int kTurns = 16;
  for (int turn = 0; turn < kTurns; ++turn) {
    double mm = 0.0;
    expected.evaluate(state, drive, target_m, turn * 0.1, &mm, nullptr, workspace);
    expected_mm += mm / kTurns;
  }
  double mean_mm = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    double next[3];
    expected.draw(0, state, random, next, workspace);
    mean_mm += cost.at({next[0], next[1]}, {target_m[0], target_m[1]}) / kDraws;
  }
  CHECK(mean_mm == Approx(expected_mm).epsilon(0.05));
}
