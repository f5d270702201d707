#include "fold.h"

#include <cmath>
#include <cstdint>

#include "lodestone/common/error.h"

namespace lodestone::inference {
namespace {

constexpr double kBatchNormEpsilon = 1e-5;  // torch::nn::BatchNorm1d's own

using Numbers = std::vector<double>;

struct WideLayer {
  Numbers weight;  // [outputs, inputs]
  Numbers bias;
};

/// Gathers linear maps and normalisations into as few linear layers as possible.
class Folder {
 public:
  /// Starts with x -> (x - mean) / spread.
  Folder(const Numbers& mean, const Numbers& spread) : scale_(mean.size()), shift_(mean.size()) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      scale_[i] = 1.0 / spread[i];
      shift_[i] = -mean[i] * scale_[i];
    }
  }

  void add_linear(Numbers weight, Numbers bias) {
    const std::size_t inputs = scale_.size();
    for (std::size_t row = 0; row < bias.size(); ++row) {
      double* weights = &weight[row * inputs];
      double sum = 0.0;
      for (std::size_t i = 0; i < inputs; ++i) {
        sum += weights[i] * shift_[i];
        weights[i] *= scale_[i];
      }
      bias[row] += sum;
    }
    layers_.push_back({std::move(weight), std::move(bias)});
    after_linear_ = true;
  }

  void add_relu() {
    scale_.assign(layers_.back().bias.size(), 1.0);
    shift_.assign(layers_.back().bias.size(), 0.0);
    after_linear_ = false;
  }

  /// y = scale * x + shift: into the linear layer before it, or kept for the one that follows.
  void affine(const Numbers& scale, const Numbers& shift) {
    Numbers& bias = after_linear_ ? layers_.back().bias : shift_;
    for (std::size_t i = 0; i < scale.size(); ++i) {
      bias[i] = bias[i] * scale[i] + shift[i];
      if (!after_linear_) {
        scale_[i] *= scale[i];
        continue;
      }
      const std::size_t inputs = layers_.back().weight.size() / scale.size();
      for (std::size_t j = 0; j < inputs; ++j) layers_.back().weight[i * inputs + j] *= scale[i];
    }
  }

  std::vector<LinearLayer> layers() const {
    std::vector<LinearLayer> narrow;
    for (const WideLayer& layer : layers_)
      narrow.push_back({{layer.weight.begin(), layer.weight.end()}, {layer.bias.begin(), layer.bias.end()}});
    return narrow;
  }

 private:
  std::vector<WideLayer> layers_;
  Numbers scale_, shift_;
  bool after_linear_ = false;
};

}  // namespace

const Array& weight_at(const Arrays& weights, const std::string& name, const std::vector<std::int64_t>& shape,
                       const std::string& what) {
  const auto found = weights.find(name);
  if (found == weights.end()) throw common::CheckpointError(what + ": array \"" + name + "\" is missing");
  if (found->second.shape() != shape || found->second.type() != ElementType::kFloat32) {
    throw common::CheckpointError(what + ": array \"" + name + "\" is " + found->second.text() +
                                  ", expected " + Array(ElementType::kFloat32, shape, nullptr).text());
  }
  return found->second;
}

std::vector<LinearLayer> fold(const Arrays& weights, const DynamicsConfig& config, data::StateLayout layout,
                              const std::string& what) {
  const auto numbers = [&](const std::string& name, const std::vector<std::int64_t>& shape) {
    return weight_at(weights, name, shape, what).to_double();
  };
  std::int64_t place = 0;  // in nets::DynamicsNetwork's sequence of layers
  std::int64_t width = config.inputs(layout);
  Folder folder(numbers("input_mean", {width}), numbers("input_std", {width}));
  const auto add_batch_norm = [&] {
    if (!config.batch_norm) return;
    const std::string prefix = "layers." + std::to_string(place++) + ".";
    Numbers scale = numbers(prefix + "weight", {width});
    Numbers shift = numbers(prefix + "bias", {width});
    const Numbers mean = numbers(prefix + "running_mean", {width});
    const Numbers variance = numbers(prefix + "running_var", {width});
    for (std::size_t i = 0; i < scale.size(); ++i) {
      scale[i] /= std::sqrt(variance[i] + kBatchNormEpsilon);
      shift[i] -= mean[i] * scale[i];
    }
    folder.affine(scale, shift);
  };
  const auto add_linear = [&](std::int64_t outputs) {
    const std::string prefix = "layers." + std::to_string(place++) + ".";
    folder.add_linear(numbers(prefix + "weight", {outputs, width}), numbers(prefix + "bias", {outputs}));
    width = outputs;
  };
  add_batch_norm();
  for (const std::int64_t hidden : config.hidden) {
    add_linear(hidden);
    add_batch_norm();
    folder.add_relu();
    ++place;
  }
  const std::int64_t states = data::state_size(layout);
  add_linear(config.components > 0 ? config.mixture(layout).outputs() : states);
  if (config.components == 0)
    folder.affine(numbers("output_std", {states}), numbers("output_mean", {states}));
  return folder.layers();
}

}  // namespace lodestone::inference
