#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "lodestone/inference/dynamics.h"

namespace lodestone::env::tests {

/// Start states on a spiral over 40 mm.
inline std::vector<double> spiral(data::StateLayout layout) {
  constexpr int kStarts = 500;
  std::vector<double> states;
  for (int i = 0; i < kStarts; ++i) {
    const double part = static_cast<double>(i) / kStarts;
    states.push_back(0.04 * part * std::cos(40.0 * part));
    states.push_back(0.04 * part * std::sin(40.0 * part));
    if (layout == data::StateLayout::kPose) states.push_back(3.0 * std::sin(17.0 * part));
  }
  return states;
}

/// Normalisers that change nothing.
inline inference::Arrays without_normalisation(std::int64_t inputs, std::int64_t states) {
  const auto all = [](std::int64_t count, float value) {
    return inference::Array(std::vector<float>(static_cast<std::size_t>(count), value), {count});
  };
  return {{"input_mean", all(inputs, 0.0F)},
          {"input_std", all(inputs, 1.0F)},
          {"output_mean", all(states, 0.0F)},
          {"output_std", all(states, 1.0F)}};
}

/// The two layers that pass `gain_m` metres per unit of drive on to the first two of `outputs` numbers, which
/// begin with row `from`; the biases of the second one stay to be set.
inline inference::Arrays passing_drive_on(std::int64_t inputs, std::int64_t states, std::int64_t outputs,
                                          std::int64_t from, double gain) {
  std::vector<float> first(static_cast<std::size_t>(4 * inputs));
  std::vector<float> second(static_cast<std::size_t>(outputs * 4));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::size_t drive = static_cast<std::size_t>(inputs) - 2 + axis;
    const std::size_t row = 4 * (static_cast<std::size_t>(from) + axis);
    first[2 * axis * static_cast<std::size_t>(inputs) + drive] = 1.0F;
    first[(2 * axis + 1) * static_cast<std::size_t>(inputs) + drive] = -1.0F;
    second[row + 2 * axis] = static_cast<float>(gain);
    second[row + 2 * axis + 1] = -static_cast<float>(gain);
  }
  inference::Arrays weights = without_normalisation(inputs, states);
  weights["layers.0.weight"] = {std::move(first), {4, inputs}};
  weights["layers.0.bias"] = {std::vector<float>(4), {4}};
  weights["layers.2.weight"] = {std::move(second), {outputs, 4}};
  return weights;
}

inline inference::DynamicsModel empty_linear_model(data::StateLayout layout, std::size_t members) {
  inference::DynamicsModel model;
  model.config.form = inference::DynamicsForm::kDelta;
  model.config.hidden = {4};  // x and y drives as differences of two ReLUs each
  model.config.batch_norm = false;
  model.config.members = static_cast<std::int64_t>(members);
  model.info.layout = layout;
  model.info.action_scale = 10.0;
  model.info.workspace_radius_m = 0.0425;
  model.start_states = spiral(layout);
  return model;
}

/// An ensemble whose member k moves the robot by exactly `gain_m[k]` metres per unit of drive along each axis
/// and turns it by `turn_rad[k]` a step: a learned simulator with a known answer. Of a drive of more than two
/// numbers it is the last two that do.
inline inference::DynamicsModel linear_model(data::StateLayout layout, const std::vector<double>& gain_m,
                                             const std::vector<double>& turn_rad, int action_size = 2) {
  inference::DynamicsModel model = empty_linear_model(layout, gain_m.size());
  model.info.action_size = action_size;
  const std::int64_t states = data::state_size(layout);
  for (std::size_t k = 0; k < gain_m.size(); ++k) {
    inference::Arrays weights =
        passing_drive_on(model.config.inputs(model.info.rows()), states, states, 0, gain_m[k]);
    std::vector<float> bias(static_cast<std::size_t>(states));
    if (layout == data::StateLayout::kPose) bias[2] = static_cast<float>(turn_rad[k]);
    weights["layers.2.bias"] = {std::move(bias), {states}};
    model.members.emplace_back(weights, model.config, model.info.rows(), "linear model");
  }
  return model;
}

/// Standard deviation in m of every number that noisy_linear_model predicts.
constexpr double kLinearNoise_m = 0.2e-3;

/// One member that moves the robot by `gain_m` metres per unit of drive, does not turn it, and is unsure of
/// all three by kLinearNoise_m (or rad): a mixture of one. Of more numbers the last two move it, as above.
inline inference::DynamicsModel noisy_linear_model(double gain_m, int action_size = 2) {
  constexpr data::StateLayout kLayout = data::StateLayout::kPose;
  inference::DynamicsModel model = empty_linear_model(kLayout, 1);
  model.config.components = 1;
  model.info.action_size = action_size;
  const std::int64_t outputs = model.config.mixture(kLayout).outputs();
  constexpr double kUnit_m = 1e-3;
  inference::Arrays weights =
      passing_drive_on(model.config.inputs(model.info.rows()), 3, outputs, 1, gain_m / kUnit_m);
  std::vector<float> bias(static_cast<std::size_t>(outputs));
  const double part = (std::log(kLinearNoise_m / kUnit_m) - inference::kLeastLogSpread) /
                      (inference::kMostLogSpread - inference::kLeastLogSpread);
  for (std::size_t i = 4; i < 7; ++i) bias[i] = static_cast<float>(std::log(part / (1.0 - part)));
  weights["layers.2.bias"] = {std::move(bias), {outputs}};
  weights["output_std"] = {std::vector<float>(3, static_cast<float>(kUnit_m)), {3}};
  model.members.emplace_back(weights, model.config, model.info.rows(), "noisy linear model");
  return model;
}

}  // namespace lodestone::env::tests
