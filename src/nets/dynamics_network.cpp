#include "lodestone/nets/dynamics_network.h"

#include <cmath>

#include <torch/nn/modules/activation.h>

#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/mlp.h"

namespace lodestone::nets {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kHeading = 2;               ///< column of the heading in a pose state
constexpr double kSmallestSpread = 1e-9;  ///< a column that never varies keeps its unit

void fit(torch::Tensor& mean, torch::Tensor& spread, const torch::Tensor& rows) {
  const torch::Tensor wide = rows.to(torch::kFloat64);
  torch::Tensor std = wide.std(0, /*unbiased=*/false);
  std = torch::where(std < kSmallestSpread, torch::ones_like(std), std);
  mean.copy_(wide.mean(0));
  spread.copy_(std);
}

}  // namespace

torch::Tensor wrap_angles(const torch::Tensor& angle_rad) {
  return angle_rad - 2.0 * kPi * torch::ceil((angle_rad - kPi) / (2.0 * kPi));
}

DynamicsNetworkImpl::DynamicsNetworkImpl(const DynamicsConfig& config, data::StateLayout layout)
    : config_(config), layout_(layout) {
  const std::int64_t inputs = config.inputs(layout);
  const std::int64_t outputs = data::state_size(layout);
  input_mean = register_buffer("input_mean", torch::zeros({inputs}));
  input_std = register_buffer("input_std", torch::ones({inputs}));
  output_mean = register_buffer("output_mean", torch::zeros({outputs}));
  output_std = register_buffer("output_std", torch::ones({outputs}));

  torch::nn::Sequential layers;
  if (config.batch_norm) layers->push_back(torch::nn::BatchNorm1d(inputs));
  std::int64_t width = inputs;
  for (const std::int64_t hidden : config.hidden) {
    layers->push_back(torch::nn::Linear(width, hidden));
    if (config.batch_norm) layers->push_back(torch::nn::BatchNorm1d(hidden));
    layers->push_back(torch::nn::ReLU());
    width = hidden;
  }
  layers->push_back(torch::nn::Linear(width, config.components > 0 ? mixture().outputs() : outputs));
  layers_ = register_module("layers", layers);
}

torch::Tensor DynamicsNetworkImpl::features(const torch::Tensor& state, const torch::Tensor& action) const {
  if (!config_.sine_cosine(layout_)) return torch::cat({state, action}, 1);
  const torch::Tensor heading = state.narrow(1, kHeading, 1);
  return torch::cat({state.narrow(1, 0, kHeading), torch::sin(heading), torch::cos(heading), action}, 1);
}

torch::Tensor DynamicsNetworkImpl::normalised_input(const torch::Tensor& state,
                                                    const torch::Tensor& action) const {
  return ((features(state, action) - input_mean) / input_std).to(torch::kFloat32);
}

torch::Tensor DynamicsNetworkImpl::normalised_output(const torch::Tensor& state,
                                                     const torch::Tensor& action) {
  const torch::Tensor raw = layers_->forward(normalised_input(state, action));
  return config_.components > 0 ? mixture_mean(raw, mixture()) : raw;
}

torch::Tensor DynamicsNetworkImpl::normalised_target(const torch::Tensor& state,
                                                     const torch::Tensor& next_state) const {
  torch::Tensor target = next_state;
  if (config_.predicts_change()) {
    target = next_state - state;
    if (layout_ == data::StateLayout::kPose) {
      target = torch::cat({target.narrow(1, 0, kHeading), wrap_angles(target.narrow(1, kHeading, 1))}, 1);
    }
  }
  return ((target - output_mean) / output_std).to(torch::kFloat32);
}

torch::Tensor DynamicsNetworkImpl::forward(const torch::Tensor& state, const torch::Tensor& action) {
  torch::Tensor next = normalised_output(state, action) * output_std + output_mean;
  if (config_.predicts_change()) next = state + next;
  if (layout_ == data::StateLayout::kPosition) return next;
  return torch::cat({next.narrow(1, 0, kHeading), wrap_angles(next.narrow(1, kHeading, 1))}, 1);
}

void DynamicsNetworkImpl::fit_normalisers(const torch::Tensor& state, const torch::Tensor& action,
                                          const torch::Tensor& next_state) {
  const torch::NoGradGuard no_grad;
  fit(input_mean, input_std, features(state, action));
  output_mean.zero_();
  output_std.fill_(1.0);
  torch::Tensor target = next_state.to(torch::kFloat64);
  if (config_.predicts_change()) {
    target = target - state.to(torch::kFloat64);
    if (layout_ == data::StateLayout::kPose)
      target.select(1, kHeading).copy_(wrap_angles(target.select(1, kHeading)));
  }
  fit(output_mean, output_std, target);
}

std::vector<std::shared_ptr<DynamicsNetworkImpl>> make_dynamics_members(const DynamicsConfig& config,
                                                                        data::StateLayout layout,
                                                                        std::uint64_t seed) {
  std::vector<std::shared_ptr<DynamicsNetworkImpl>> members;
  for (std::int64_t k = 0; k < config.members; ++k) {
    members.push_back(std::make_shared<DynamicsNetworkImpl>(config, layout));
    common::RandomStream random(seed, "dynamics", static_cast<std::uint64_t>(k));
    initialise_linear_layers(*members.back(), random);
  }
  return members;
}

inference::FoldedDynamics fold(const DynamicsNetworkImpl& network) {
  return {to_arrays(module_tensors(network)), network.config(), network.layout(), "dynamics network"};
}

torch::Tensor predict_mean(DynamicsModel& model, const torch::Tensor& state, const torch::Tensor& action) {
  LODESTONE_CHECK(!model.members.empty(), "the ensemble has no member");
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> next;
  for (const auto& member : model.members) {
    member->eval();
    next.push_back(member->forward(state, action));
  }
  const torch::Tensor all = torch::stack(next);
  torch::Tensor mean = all.mean(0);
  if (model.info.layout == data::StateLayout::kPose) {
    const torch::Tensor headings = all.select(2, kHeading);
    mean.select(1, kHeading).copy_(torch::atan2(torch::sin(headings).mean(0), torch::cos(headings).mean(0)));
  }
  return mean;
}

}  // namespace lodestone::nets
