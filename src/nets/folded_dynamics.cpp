#include "lodestone/nets/folded_dynamics.h"

#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::nets {
namespace {

/// Gathers linear maps and normalisations into as few linear layers as possible, in float64.
class Folder {
 public:
  /// Starts with x -> (x - mean) / spread.
  Folder(const torch::Tensor& mean, const torch::Tensor& spread) {
    scale_ = spread.to(torch::kFloat64).reciprocal();
    shift_ = -mean.to(torch::kFloat64) * scale_;
  }

  void add(const torch::nn::LinearImpl& linear) {
    const torch::Tensor weight = linear.weight.detach().to(torch::kFloat64);
    weights_.push_back(weight * scale_);
    biases_.push_back(linear.bias.detach().to(torch::kFloat64) + torch::mv(weight, shift_));
    after_linear_ = true;
  }

  void add(const torch::nn::BatchNorm1dImpl& norm) {
    const torch::Tensor scale = norm.weight.detach().to(torch::kFloat64) /
                                torch::sqrt(norm.running_var.to(torch::kFloat64) + norm.options.eps());
    affine(scale, norm.bias.detach().to(torch::kFloat64) - norm.running_mean.to(torch::kFloat64) * scale);
  }

  void add_relu() {
    scale_ = torch::ones_like(biases_.back());
    shift_ = torch::zeros_like(biases_.back());
    after_linear_ = false;
  }

  /// y = scale * x + shift: into the linear layer before it, or kept for the one that follows.
  void affine(const torch::Tensor& scale, const torch::Tensor& shift) {
    torch::Tensor& bias = after_linear_ ? biases_.back() : shift_;
    bias = bias * scale + shift;
    if (after_linear_) {
      weights_.back() = weights_.back() * scale.unsqueeze(1);
    } else {
      scale_ = scale_ * scale;
    }
  }

  const std::vector<torch::Tensor>& weights() const { return weights_; }
  const std::vector<torch::Tensor>& biases() const { return biases_; }

 private:
  std::vector<torch::Tensor> weights_;
  std::vector<torch::Tensor> biases_;
  torch::Tensor scale_;
  torch::Tensor shift_;
  bool after_linear_ = false;
};

}  // namespace

FoldedDynamics::FoldedDynamics(DynamicsNetwork& network)
    : state_size_(data::state_size(network->layout())),
      predicts_change_(network->config().form == "delta"),
      sine_cosine_(predicts_change_ && network->layout() == data::StateLayout::kPose),
      mixture_(network->mixture()),
      output_mean_(static_cast<std::size_t>(state_size_), 0.0F),
      output_std_(static_cast<std::size_t>(state_size_), 1.0F) {
  const torch::NoGradGuard no_grad;
  Folder folder(network->input_mean, network->input_std);
  for (const auto& child : network->layers()->children()) {
    if (const auto* linear = child->as<torch::nn::LinearImpl>()) {
      folder.add(*linear);
    } else if (const auto* norm = child->as<torch::nn::BatchNorm1dImpl>()) {
      folder.add(*norm);
    } else {
      LODESTONE_CHECK(child->as<torch::nn::ReLUImpl>() != nullptr,
                      "only linear, batch norm and ReLU can be folded");
      folder.add_relu();
    }
  }
  if (mixture_.components == 0) {
    folder.affine(network->output_std.to(torch::kFloat64), network->output_mean.to(torch::kFloat64));
  } else {
    std::copy_n(network->output_mean.contiguous().data_ptr<float>(), state_size_, output_mean_.begin());
    std::copy_n(network->output_std.contiguous().data_ptr<float>(), state_size_, output_std_.begin());
  }
  for (std::size_t i = 0; i < folder.weights().size(); ++i) {
    const torch::Tensor weight = folder.weights()[i].to(torch::kFloat32).contiguous();
    layers_.push_back({PackedMatrix<float>({weight.data_ptr<float>(), weight.size(1), weight.size(0), true}),
                       folder.biases()[i].to(torch::kFloat32).contiguous()});
  }
}

void FoldedDynamics::write_features(const double* state, const double* drive, std::int64_t rows,
                                    float* out) const {
  for (std::int64_t row = 0; row < rows; ++row, state += state_size_, drive += data::kActionSize) {
    *out++ = static_cast<float>(state[0]);
    *out++ = static_cast<float>(state[1]);
    if (sine_cosine_) {
      *out++ = std::sin(static_cast<float>(state[2]));
      *out++ = std::cos(static_cast<float>(state[2]));
    } else if (state_size_ == 3) {
      *out++ = static_cast<float>(state[2]);
    }
    *out++ = static_cast<float>(drive[0]);
    *out++ = static_cast<float>(drive[1]);
  }
}

void FoldedDynamics::write_next(const double* state, const float* output, std::int64_t rows,
                                double* next) const {
  const auto size = static_cast<std::size_t>(state_size_);
  const double keep = predicts_change_ ? 1.0 : 0.0;
  for (std::int64_t row = 0; row < rows; ++row, state += size, output += size, next += size) {
    for (std::size_t i = 0; i < size; ++i)
      next[i] = keep * state[i] + static_cast<double>(output_mean_[i] + output_std_[i] * output[i]);
    if (size == 3) next[2] = geometry::wrap_angle(next[2]);
  }
}

const float* FoldedDynamics::evaluate(const double* state, const double* drive, std::int64_t rows,
                                      Workspace& workspace) const {
  std::vector<torch::Tensor>& buffers = workspace.activations_;
  if (workspace.rows_ < rows || buffers.size() != layers_.size() + 1) {
    buffers.assign(1, torch::empty({rows, layers_.front().weight.k()}));
    for (const Layer& layer : layers_) buffers.push_back(torch::empty({rows, layer.weight.n()}));
    workspace.rows_ = rows;
  }
  write_features(state, drive, rows, buffers.front().data_ptr<float>());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Layer& layer = layers_[i];
    multiply<float>({buffers[i].data_ptr<float>(), rows, layer.weight.k()}, layer.weight,
                    buffers[i + 1].data_ptr<float>(),
                    {layer.bias.data_ptr<float>(), i + 1 < layers_.size(), nullptr});
  }
  return buffers.back().data_ptr<float>();
}

void FoldedDynamics::predict(const double* state, const double* drive, std::int64_t rows, double* next,
                             Workspace& workspace) const {
  if (rows == 0) return;
  const float* output = evaluate(state, drive, rows, workspace);
  if (mixture_.components == 0) return write_next(state, output, rows, next);
  float mean[3];
  for (std::int64_t row = 0; row < rows; ++row) {
    mixture_mean(output + row * mixture_.outputs(), mixture_, mean);
    write_next(state + row * state_size_, mean, 1, next + row * state_size_);
  }
}

void FoldedDynamics::sample(const double* state, const double* drive, std::int64_t rows,
                            common::RandomStream* const* random, double* next, Workspace& workspace) const {
  if (mixture_.components == 0) return predict(state, drive, rows, next, workspace);
  if (rows == 0) return;
  const float* output = evaluate(state, drive, rows, workspace);
  float drawn[3];
  for (std::int64_t row = 0; row < rows; ++row) {
    mixture_draw(output + row * mixture_.outputs(), mixture_, *random[row], drawn);
    write_next(state + row * state_size_, drawn, 1, next + row * state_size_);
  }
}

}  // namespace lodestone::nets
