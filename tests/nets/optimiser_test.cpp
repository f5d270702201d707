#include "lodestone/nets/optimiser.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>
#include <torch/optim/adam.h>
#include <torch/optim/sgd.h>

namespace {

using namespace lodestone::nets;

constexpr std::int64_t kCount = 37;

at::Tensor wave(double phase, at::ScalarType type) {
  return (0.37 * at::arange(kCount, at::kDouble) + phase).sin().to(type);
}

/// Parameters after some steps of a LibTorch optimiser on the gradients that wave() gives.
template <class Optimiser>
at::Tensor reference(const at::Tensor& start, Optimiser optimiser, at::Tensor& parameters, int steps) {
  parameters.set_data(start.clone());
  for (int step = 1; step <= steps; ++step) {
    parameters.mutable_grad() = wave(step, start.scalar_type());
    optimiser.step();
  }
  return parameters.detach();
}

template <class Real>
double adam_difference(at::ScalarType type) {
  constexpr int kSteps = 50;
  at::Tensor parameters = wave(0.0, type);
  at::Tensor first = at::zeros_like(parameters);
  at::Tensor second = at::zeros_like(parameters);
  at::Tensor leaf = at::zeros({kCount}, type).set_requires_grad(true);
  const at::Tensor expected =
      reference(parameters, torch::optim::Adam({leaf}, torch::optim::AdamOptions(1e-2)), leaf, kSteps);
  for (int step = 1; step <= kSteps; ++step) {
    const at::Tensor gradient = wave(step, type);
    adam_step(parameters.data_ptr<Real>(), gradient.data_ptr<Real>(), first.data_ptr<Real>(),
              second.data_ptr<Real>(), kCount, 1e-2, step);
  }
  CHECK((parameters - wave(0.0, type)).abs().max().template item<double>() > 0.01);  // it went somewhere
  return (parameters - expected).abs().max().template item<double>();
}

}  // namespace

TEST_CASE("Adam's steps are LibTorch's", "[unit]") {
  CHECK(adam_difference<double>(at::kDouble) < 1e-14);
  CHECK(adam_difference<float>(at::kFloat) < 2e-6);
}

TEST_CASE("descent with momentum is LibTorch's", "[unit]") {
  at::Tensor parameters = wave(0.0, at::kFloat);
  at::Tensor velocity = at::zeros_like(parameters);
  at::Tensor leaf = at::zeros({kCount}).set_requires_grad(true);
  const at::Tensor expected = reference(
      parameters, torch::optim::SGD({leaf}, torch::optim::SGDOptions(1e-2).momentum(0.9)), leaf, 20);
  for (int step = 1; step <= 20; ++step) {
    const at::Tensor gradient = wave(step, at::kFloat);
    momentum_step(parameters.data_ptr<float>(), gradient.data_ptr<float>(), velocity.data_ptr<float>(),
                  kCount, 1e-2, 0.9);
  }
  CHECK((parameters - expected).abs().max().item<double>() < 1e-6);
}

TEST_CASE("Polyak averaging takes its part of the source", "[unit]") {
  double target[2] = {1.0, -2.0};
  const double source[2] = {3.0, 2.0};
  polyak_step(target, source, 2, 0.25);
  CHECK(target[0] == 1.5);
  CHECK(target[1] == -1.0);
  float sum[2] = {1.0F, 2.0F};
  const float addend[2] = {4.0F, -8.0F};
  add_scaled(sum, addend, 2, 0.5);
  CHECK(sum[0] == 3.0F);
  CHECK(sum[1] == -2.0F);
}
