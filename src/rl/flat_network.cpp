#include "lodestone/rl/flat_network.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <ATen/ops/zeros.h>
#include <ATen/ops/zeros_like.h>

#include "lodestone/common/error.h"

namespace lodestone::rl {
namespace {

constexpr std::int64_t kAlignment = 16;  // numbers: each matrix starts on a cache line

std::int64_t padded(std::int64_t count) { return (count + kAlignment - 1) / kAlignment * kAlignment; }

template <class Real>
constexpr at::ScalarType kType = c10::CppTypeToScalarType<Real>::value;

template <class Real>
Real* data(const at::Tensor& tensor) {
  return tensor.data_ptr<Real>();
}

}  // namespace

template <class Real>
FlatNetwork<Real>::FlatNetwork(std::vector<std::int64_t> widths) : widths_(std::move(widths)) {
  LODESTONE_CHECK(widths_.size() >= 2, "a network needs an input and an output width");
  std::int64_t total = 0;
  for (std::size_t i = 0; i + 1 < widths_.size(); ++i) {
    const std::int64_t bias = total + padded(widths_[i] * widths_[i + 1]);
    layers_.push_back({widths_[i], widths_[i + 1], total, bias});
    total = bias + padded(widths_[i + 1]);
  }
  parameters_ = at::zeros({total}, kType<Real>);
}

template <class Real>
FlatNetwork<Real> FlatNetwork<Real>::clone() const {
  FlatNetwork copy(widths_);
  copy.parameters_.copy_(parameters_);
  copy.rounds_ = rounds_;
  return copy;
}

template <class Real>
void FlatNetwork<Real>::initialise(common::RandomStream& random) {
  Real* parameters = data<Real>(parameters_);
  for (const Layer& layer : layers_) {
    const double bound = 1.0 / std::sqrt(static_cast<double>(layer.in));
    const auto draw = [&](Real* values, std::int64_t count) {
      std::generate_n(values, count, [&] { return static_cast<Real>(random.uniform(-bound, bound)); });
    };
    draw(parameters + layer.weight, layer.in * layer.out);
    draw(parameters + layer.bias, layer.out);
  }
}

template <class Real>
typename FlatNetwork<Real>::Workspace FlatNetwork<Real>::workspace(std::int64_t rows) const {
  Workspace result;
  result.rows = rows;
  for (std::size_t i = 1; i + 1 < widths_.size(); ++i) {
    result.hidden.push_back(at::zeros({rows, widths_[i]}, kType<Real>));
    result.delta.push_back(at::zeros({rows, widths_[i]}, kType<Real>));
  }
  result.output = at::zeros({rows, widths_.back()}, kType<Real>);
  result.input_gradient = at::zeros({rows, widths_.front()}, kType<Real>);
  result.gradient = at::zeros_like(parameters_);
  result.scratch = std::make_shared<Scratch>();
  return result;
}

template <class Real>
void FlatNetwork<Real>::product(const inference::LeftSide<Real>& a, const inference::RightSide<Real>& b,
                                Workspace& workspace, Real* out,
                                const inference::Epilogue<Real>& epilogue) const {
  if constexpr (std::is_same_v<Real, float>)
    if (rounds_) return inference::multiply_bf16(a, b, workspace.scratch->bf16, out, epilogue);
  inference::multiply<Real>(a, b, workspace.scratch->panel, out, epilogue);
}

template <class Real>
void FlatNetwork<Real>::forward(const Real* input, Workspace& workspace) const {
  const Real* parameters = data<Real>(parameters_);
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Layer& layer = layers_[i];
    const bool last = i + 1 == layers_.size();
    Real* output = data<Real>(last ? workspace.output : workspace.hidden[i]);
    product({input, workspace.rows, layer.in},
            {parameters + layer.weight, layer.in, layer.out, /*transposed=*/true}, workspace, output,
            {parameters + layer.bias, !last, nullptr});
    input = output;
  }
}

template <class Real>
void FlatNetwork<Real>::parameter_gradient(const Layer& layer, const Real* input, const Real* delta,
                                           Workspace& workspace) const {
  Real* gradient = data<Real>(workspace.gradient);
  const std::int64_t stride = inference::padded_stride(workspace.rows);
  Real* transposed = workspace.scratch->transposed.at_least(layer.out * stride);
  inference::transpose(delta, workspace.rows, layer.out, transposed, stride);
  product({transposed, layer.out, stride}, {input, workspace.rows, layer.in}, workspace,
          gradient + layer.weight);
  Real* __restrict bias = gradient + layer.bias;
  std::fill_n(bias, layer.out, Real(0));
  for (std::int64_t row = 0; row < workspace.rows; ++row) {
    const Real* __restrict from = delta + row * layer.out;
    for (std::int64_t j = 0; j < layer.out; ++j) bias[j] += from[j];
  }
}

template <class Real>
void FlatNetwork<Real>::backward(const Real* input, const Real* output_gradient, Workspace& workspace,
                                 Wanted wanted) const {
  const Real* parameters = data<Real>(parameters_);
  const Real* delta = output_gradient;
  for (std::size_t i = layers_.size(); i-- > 0;) {
    const Layer& layer = layers_[i];
    const Real* below = i == 0 ? input : data<Real>(workspace.hidden[i - 1]);
    if (wanted == Wanted::kParameters) parameter_gradient(layer, below, delta, workspace);
    if (i == 0 && wanted == Wanted::kParameters) return;
    Real* passed_on = data<Real>(i == 0 ? workspace.input_gradient : workspace.delta[i - 1]);
    product({delta, workspace.rows, layer.out}, {parameters + layer.weight, layer.out, layer.in}, workspace,
            passed_on, {nullptr, false, i == 0 ? nullptr : below});
    delta = passed_on;
  }
}

template <class Real>
nets::NamedTensors FlatNetwork<Real>::named(const at::Tensor& flat, const std::string& prefix,
                                            int first) const {
  nets::NamedTensors result;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Layer& at = layers_[i];
    const std::string layer = prefix + "l" + std::to_string(first + static_cast<int>(i));
    result[layer + ".weight"] = flat.narrow(0, at.weight, at.in * at.out).view({at.out, at.in});
    result[layer + ".bias"] = flat.narrow(0, at.bias, at.out);
  }
  return result;
}

template class FlatNetwork<float>;
template class FlatNetwork<double>;

}  // namespace lodestone::rl
