#include "lodestone/rl/flat_network.h"

#include <cmath>

#include "lodestone/common/error.h"

namespace lodestone::rl {
namespace {

constexpr std::int64_t kAlignment = 16;  // numbers: each matrix starts on a cache line

std::int64_t padded(std::int64_t count) { return (count + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

FlatNetwork::FlatNetwork(std::vector<std::int64_t> widths, torch::ScalarType type)
    : widths_(std::move(widths)) {
  LODESTONE_CHECK(widths_.size() >= 2, "a network needs an input and an output width");
  std::int64_t total = 0;
  for (std::size_t i = 0; i + 1 < widths_.size(); ++i) {
    offsets_.push_back(total);
    total += padded(widths_[i] * widths_[i + 1]);
    offsets_.push_back(total);
    total += padded(widths_[i + 1]);
  }
  parameters_ = torch::zeros({total}, type);
  weights_ = views(parameters_, true);
  biases_ = views(parameters_, false);
}

FlatNetwork FlatNetwork::clone() const {
  FlatNetwork copy(widths_, parameters_.scalar_type());
  copy.parameters_.copy_(parameters_);
  return copy;
}

std::vector<torch::Tensor> FlatNetwork::views(const torch::Tensor& flat, bool weights) const {
  std::vector<torch::Tensor> result;
  for (std::size_t i = 0; i + 1 < widths_.size(); ++i) {
    const std::int64_t in = widths_[i];
    const std::int64_t out = widths_[i + 1];
    result.push_back(weights ? flat.narrow(0, offsets_[2 * i], in * out).view({out, in})
                             : flat.narrow(0, offsets_[2 * i + 1], out));
  }
  return result;
}

void FlatNetwork::initialise(common::RandomStream& random) {
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const double bound = 1.0 / std::sqrt(static_cast<double>(widths_[i]));
    for (torch::Tensor* tensor : {&weights_[i], &biases_[i]}) {
      torch::Tensor drawn = torch::empty(tensor->sizes(), torch::kFloat64);
      double* values = drawn.data_ptr<double>();
      for (std::int64_t k = 0; k < drawn.numel(); ++k) values[k] = random.uniform(-bound, bound);
      tensor->copy_(drawn);
    }
  }
}

FlatNetwork::Workspace FlatNetwork::workspace(std::int64_t rows) const {
  const auto type = parameters_.scalar_type();
  Workspace result;
  for (std::size_t i = 1; i + 1 < widths_.size(); ++i) {
    result.hidden.push_back(torch::zeros({rows, widths_[i]}, type));
    result.delta.push_back(torch::zeros({rows, widths_[i]}, type));
  }
  result.output = torch::zeros({rows, widths_.back()}, type);
  result.input_gradient = torch::zeros({rows, widths_.front()}, type);
  result.gradient = torch::zeros_like(parameters_);
  result.weight_gradient = views(result.gradient, true);
  result.bias_gradient = views(result.gradient, false);
  return result;
}

const torch::Tensor& FlatNetwork::forward(const torch::Tensor& input, Workspace& workspace) const {
  const torch::Tensor* layer_input = &input;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const bool last = i + 1 == weights_.size();
    torch::Tensor& out = last ? workspace.output : workspace.hidden[i];
    at::addmm_out(out, biases_[i], *layer_input, weights_[i].t());
    if (!last) out.clamp_min_(0.0);
    layer_input = &out;
  }
  return workspace.output;
}

void FlatNetwork::backward(const torch::Tensor& input, const torch::Tensor& output_gradient,
                           Workspace& workspace, Wanted wanted) const {
  const torch::Tensor* delta = &output_gradient;
  for (std::size_t i = weights_.size(); i-- > 0;) {
    if (wanted == Wanted::kParameters) {
      at::mm_out(workspace.weight_gradient[i], delta->t(), i == 0 ? input : workspace.hidden[i - 1]);
      at::sum_out(workspace.bias_gradient[i], *delta, {0});
    }
    if (i > 0) {
      torch::Tensor& below = workspace.delta[i - 1];
      at::mm_out(below, *delta, weights_[i]);
      at::threshold_backward_out(below, below, workspace.hidden[i - 1], 0.0);
      delta = &below;
    } else if (wanted == Wanted::kInput) {
      at::mm_out(workspace.input_gradient, *delta, weights_[0]);
    }
  }
}

nets::NamedTensors FlatNetwork::named(const torch::Tensor& flat, const std::string& prefix, int first) const {
  nets::NamedTensors result;
  const auto weights = views(flat, true);
  const auto biases = views(flat, false);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const std::string layer = prefix + "l" + std::to_string(first + static_cast<int>(i));
    result[layer + ".weight"] = weights[i];
    result[layer + ".bias"] = biases[i];
  }
  return result;
}

}  // namespace lodestone::rl
