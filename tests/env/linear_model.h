#pragma once

#include <cmath>

#include <torch/torch.h>

#include "lodestone/nets/dynamics.h"

namespace lodestone::env::tests {

/// An ensemble whose member k moves the robot by exactly `gain_m[k]` metres per unit of drive along each axis
/// and turns it by `turn_rad[k]` a step: a learned simulator with a known answer. Starts lie on a spiral over
/// 40 mm.
inline nets::DynamicsModel linear_model(data::StateLayout layout, const std::vector<double>& gain_m,
                                        const std::vector<double>& turn_rad) {
  const torch::NoGradGuard no_grad;
  nets::DynamicsModel model;
  model.config.form = "delta";
  model.config.hidden = {4};  // x and y drives as differences of two ReLUs each
  model.config.batch_norm = false;
  model.config.members = static_cast<std::int64_t>(gain_m.size());
  model.info.layout = layout;
  model.info.action_scale = 10.0;
  model.members = nets::make_dynamics_members(model.config, layout, 1);
  for (std::size_t k = 0; k < gain_m.size(); ++k) {
    nets::DynamicsNetwork& member = model.members[k];
    for (torch::Tensor& parameter : member->parameters()) parameter.zero_();
    auto parameters = member->named_parameters();
    torch::Tensor first = parameters["layers.0.weight"];
    torch::Tensor second = parameters["layers.2.weight"];
    const std::int64_t drive = first.size(1) - 2;
    for (std::int64_t axis = 0; axis < 2; ++axis) {
      first[2 * axis][drive + axis] = 1.0;
      first[2 * axis + 1][drive + axis] = -1.0;
      second[axis][2 * axis] = gain_m[k];
      second[axis][2 * axis + 1] = -gain_m[k];
    }
    if (layout == data::StateLayout::kPose) parameters["layers.2.bias"][2] = turn_rad[k];
    member->eval();
  }
  const std::int64_t starts = 500;
  const int size = data::state_size(layout);
  model.start_states = torch::zeros({starts, size}, torch::kFloat64);
  for (std::int64_t i = 0; i < starts; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(starts);
    model.start_states[i][0] = 0.04 * part * std::cos(40.0 * part);
    model.start_states[i][1] = 0.04 * part * std::sin(40.0 * part);
    if (size == 3) model.start_states[i][2] = 3.0 * std::sin(17.0 * part);
  }
  return model;
}

}  // namespace lodestone::env::tests
