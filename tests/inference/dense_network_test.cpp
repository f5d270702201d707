#include "lodestone/inference/dense_network.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using inference::DenseNetwork;

TEST_CASE("layers follow one another with ReLU in between, none at the end", "[unit]") {
  const DenseNetwork network({{{1, -1, 2, 0}, {0, -1}}, {{1, 1}, {-10}}});
  CHECK(network.inputs() == 2);
  CHECK(network.outputs() == 1);
  DenseNetwork::Workspace workspace;
  const float rows[] = {3, 1, 0, 5};
  std::copy_n(rows, 4, network.input(2, workspace));
  const float* out = network.forward(2, workspace);
  CHECK(out[0] == (3 - 1) + (2 * 3 - 1) - 10);
  CHECK(out[1] == -10);  // both hidden numbers are below zero
  // One row by itself in the workspace that was larger.
  std::copy_n(rows, 2, network.input(1, workspace));
  CHECK(network.forward(1, workspace)[0] == -3);
}

TEST_CASE("layers that do not fit are refused", "[unit]") {
  CHECK_THROWS_AS(DenseNetwork({}), common::LogicFault);
  CHECK_THROWS_AS(DenseNetwork({{{1, 2, 3}, {0, 0}}}), common::LogicFault);
  CHECK_THROWS_AS(DenseNetwork({{{1, 2}, {0, 0}}, {{1}, {0}}}), common::LogicFault);
}

TEST_CASE("weights are named when they are missing or of another shape or type", "[unit]") {
  const inference::Arrays weights = {{"w", {std::vector<float>{1, 2}, {1, 2}}},
                                     {"d", {std::vector<double>{1, 2}, {1, 2}}}};
  CHECK(inference::weight_at(weights, "w", {1, 2}, "it").size() == 2);
  CHECK_THROWS_WITH(inference::weight_at(weights, "v", {1, 2}, "it"), "it: array \"v\" is missing");
  CHECK_THROWS_WITH(inference::weight_at(weights, "w", {2}, "it"),
                    "it: array \"w\" is [1, 2] float32, expected [2] float32");
  CHECK_THROWS_AS(inference::weight_at(weights, "d", {1, 2}, "it"), common::CheckpointError);
}
