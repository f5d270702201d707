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

/// An ensemble whose member k moves the robot by exactly `gain_m[k]` metres per unit of drive along each axis
/// and turns it by `turn_rad[k]` a step: a learned simulator with a known answer.
inline inference::DynamicsModel linear_model(data::StateLayout layout, const std::vector<double>& gain_m,
                                             const std::vector<double>& turn_rad) {
  inference::DynamicsModel model;
  model.config.form = inference::DynamicsForm::kDelta;
  model.config.hidden = {4};  // x and y drives as differences of two ReLUs each
  model.config.batch_norm = false;
  model.config.members = static_cast<std::int64_t>(gain_m.size());
  model.info.layout = layout;
  model.info.action_scale = 10.0;
  model.info.workspace_radius_m = 0.0425;
  model.start_states = spiral(layout);
  const std::int64_t inputs = model.config.inputs(layout);
  const std::int64_t states = data::state_size(layout);
  for (std::size_t k = 0; k < gain_m.size(); ++k) {
    std::vector<float> first(static_cast<std::size_t>(4 * inputs));
    std::vector<float> second(static_cast<std::size_t>(states * 4));
    std::vector<float> bias(static_cast<std::size_t>(states));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::size_t drive = static_cast<std::size_t>(inputs) - 2 + axis;
      first[2 * axis * static_cast<std::size_t>(inputs) + drive] = 1.0F;
      first[(2 * axis + 1) * static_cast<std::size_t>(inputs) + drive] = -1.0F;
      second[axis * 4 + 2 * axis] = static_cast<float>(gain_m[k]);
      second[axis * 4 + 2 * axis + 1] = -static_cast<float>(gain_m[k]);
    }
    if (layout == data::StateLayout::kPose) bias[2] = static_cast<float>(turn_rad[k]);
    inference::Arrays weights = without_normalisation(inputs, states);
    weights["layers.0.weight"] = {std::move(first), {4, inputs}};
    weights["layers.0.bias"] = {std::vector<float>(4), {4}};
    weights["layers.2.weight"] = {std::move(second), {states, 4}};
    weights["layers.2.bias"] = {std::move(bias), {states}};
    model.members.emplace_back(weights, model.config, layout, "linear model");
  }
  return model;
}

}  // namespace lodestone::env::tests
