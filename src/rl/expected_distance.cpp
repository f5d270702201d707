#include "lodestone/rl/expected_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "lodestone/common/error.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::rl {
namespace {

/// For every m beyond the dish.
constexpr double kOutside_mm_per_m = 1e5;
/// Weight of each of four points.
constexpr double kEach = 0.25;

FlatNetwork<float> network_of(const std::vector<inference::LinearLayer>& layers) {
  std::vector<std::int64_t> widths;
  for (const inference::LinearLayer& layer : layers)
    widths.push_back(static_cast<std::int64_t>(layer.weight.size() / layer.bias.size()));
  widths.push_back(static_cast<std::int64_t>(layers.back().bias.size()));
  FlatNetwork<float> network(std::move(widths));
  nets::NamedTensors tensors = network.named(network.parameters(), "");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const std::string name = "l" + std::to_string(i + 1);
    std::copy(layers[i].weight.begin(), layers[i].weight.end(),
              tensors.at(name + ".weight").data_ptr<float>());
    std::copy(layers[i].bias.begin(), layers[i].bias.end(), tensors.at(name + ".bias").data_ptr<float>());
  }
  return network;
}

}  // namespace

double DistanceCost::at(const geometry::Vector2& position_m, const geometry::Vector2& target_m,
                        geometry::Vector2* gradient) const {
  const geometry::Vector2 error_m = position_m - target_m;
  const double distance_m = error_m.norm();
  const double radius_m = position_m.norm();
  const double outside_m = std::max(0.0, radius_m - dish_radius_m);
  if (gradient != nullptr) {
    gradient->setZero();
    if (distance_m > goal_radius_m) *gradient += geometry::kMmPerM / distance_m * error_m;
    if (outside_m > 0.0) *gradient += kOutside_mm_per_m / radius_m * position_m;
  }
  return geometry::kMmPerM * std::max(goal_radius_m, distance_m) + kOutside_mm_per_m * outside_m;
}

ExpectedDistance::ExpectedDistance(const inference::FoldedDynamics& member, const DistanceCost& cost)
    : member_(member), cost_(cost), network_(network_of(member.layers())) {
  LODESTONE_CHECK(member.distribution(), "a simulator that predicts distributions");
}

ExpectedDistance::Workspace ExpectedDistance::workspace(std::int64_t rows) const {
  Workspace workspace;
  workspace.network = network_.workspace(rows);
  workspace.features.resize(static_cast<std::size_t>(workspace.network.input_gradient.numel()));
  workspace.raw_gradient.resize(static_cast<std::size_t>(workspace.network.output.numel()));
  return workspace;
}

void ExpectedDistance::evaluate(const double* state, const double* drive, const double* target_m,
                                double turn_rad, double* cost_mm, double* gradient,
                                Workspace& workspace) const {
  const std::int64_t rows = workspace.network.rows;
  const inference::MixtureLayout& mixture = member_.mixture();
  const std::int64_t size = mixture.size;
  const std::vector<float>& unit = member_.output_unit();
  member_.write_features(state, drive, rows, workspace.features.data());
  network_.forward(workspace.features.data(), workspace.network);
  const float* raw = workspace.network.output.data_ptr<float>();
  float* raw_gradient = workspace.raw_gradient.data();
  std::fill(workspace.raw_gradient.begin(), workspace.raw_gradient.end(), 0.0F);
  std::vector<float> weight(static_cast<std::size_t>(mixture.components));
  std::vector<double> component_mm(weight.size());
  std::array<geometry::Vector2, 4> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double angle_rad = turn_rad + 0.5 * geometry::kPi * static_cast<double>(i);
    points[i] = std::sqrt(2.0) * geometry::Vector2(std::cos(angle_rad), std::sin(angle_rad));
  }
  const double range = inference::kMostLogSpread - inference::kLeastLogSpread;
  for (std::int64_t row = 0; row < rows; ++row) {
    const geometry::Vector2 goal_m(target_m[2 * row], target_m[2 * row + 1]);
    const geometry::SquareView view = member_.view(state + row * size);
    inference::mixture_weights(raw, mixture, weight.data());
    cost_mm[row] = 0.0;
    for (std::int64_t k = 0; k < mixture.components; ++k) {
      const std::int64_t means = mixture.components + k * size;
      const std::int64_t spreads = means + mixture.components * size;
      const double share = static_cast<double>(weight[static_cast<std::size_t>(k)]);
      double& mean_mm = component_mm[static_cast<std::size_t>(k)];
      mean_mm = 0.0;
      for (const geometry::Vector2& point : points) {
        float output[3] = {};
        double spread[2];
        for (std::int64_t i = 0; i < 2; ++i) {
          spread[i] = inference::mixture_spread(raw[spreads + i]);
          output[i] = raw[means + i] + static_cast<float>(spread[i] * point[i]);
        }
        double next[3];
        member_.write_next(state + row * size, output, 1, next);
        geometry::Vector2 by_position;
        mean_mm += kEach * cost_.at({next[0], next[1]}, goal_m, &by_position);
        view.enter(by_position.data());
        for (std::int64_t i = 0; i < 2; ++i) {
          const double by_output =
              share * kEach * by_position[i] * static_cast<double>(unit[static_cast<std::size_t>(i)]);
          const double low = std::log(spread[i]) - inference::kLeastLogSpread;
          raw_gradient[means + i] += static_cast<float>(by_output);
          raw_gradient[spreads + i] +=
              static_cast<float>(by_output * point[i] * spread[i] * low * (1.0 - low / range));
        }
      }
      cost_mm[row] += share * mean_mm;
    }
    for (std::size_t k = 0; k < weight.size(); ++k)
      raw_gradient[k] = static_cast<float>(static_cast<double>(weight[k]) * (component_mm[k] - cost_mm[row]));
    raw += mixture.outputs();
    raw_gradient += mixture.outputs();
  }
  if (gradient == nullptr) return;
  network_.backward(workspace.features.data(), workspace.raw_gradient.data(), workspace.network,
                    FlatNetwork<float>::Wanted::kInput);
  const float* by_feature = workspace.network.input_gradient.data_ptr<float>();
  const std::int64_t features = workspace.network.input_gradient.size(1);
  for (std::int64_t row = 0; row < rows; ++row)
    member_.slope_by_drive(state + row * size, by_feature + row * features, gradient + 2 * row);
}

void ExpectedDistance::draw(std::int64_t row, const double* state, common::RandomStream& random, double* next,
                            const Workspace& workspace) const {
  const inference::MixtureLayout& mixture = member_.mixture();
  float output[3] = {};
  inference::mixture_draw(workspace.network.output.data_ptr<float>() + row * mixture.outputs(), mixture,
                          inference::Luck::draw(mixture.size, random), output);
  member_.write_next(state, output, 1, next);
}

}  // namespace lodestone::rl
