#include "lodestone/inference/dense_network.h"

#include "lodestone/common/error.h"

namespace lodestone::inference {

const Array& weight_at(const Arrays& weights, const std::string& name, const std::vector<std::int64_t>& shape,
                       const std::string& what) {
  const auto found = weights.find(name);
  if (found == weights.end()) throw common::CheckpointError(what + ": array \"" + name + "\" is missing");
  if (found->second.shape() != shape || found->second.type() != ElementType::kFloat32) {
    throw common::CheckpointError(what + ": array \"" + name + "\" is " + found->second.text() +
                                  ", expected " + Array(ElementType::kFloat32, shape, nullptr).text());
  }
  check_finite(found->second, what + ": array \"" + name + "\"");
  return found->second;
}

DenseNetwork::DenseNetwork(const std::vector<LinearLayer>& layers) {
  LODESTONE_CHECK(!layers.empty(), "a network with a layer");
  for (const LinearLayer& layer : layers) {
    const auto outputs = static_cast<std::int64_t>(layer.bias.size());
    LODESTONE_CHECK(outputs > 0 && layer.weight.size() % layer.bias.size() == 0, "a weight for every output");
    const std::int64_t inputs = static_cast<std::int64_t>(layer.weight.size()) / outputs;
    LODESTONE_CHECK(layers_.empty() || layers_.back().weight.n() == inputs, "layers that fit each other");
    layers_.push_back(
        {PackedMatrix<float>({layer.weight.data(), inputs, outputs, /*transposed=*/true}), layer.bias});
  }
}

float* DenseNetwork::input(std::int64_t rows, Workspace& workspace) const {
  if (workspace.activations_.size() <= layers_.size()) workspace.activations_.resize(layers_.size() + 1);
  return workspace.activations_.front().at_least(rows * inputs());
}

const float* DenseNetwork::forward(std::int64_t rows, Workspace& workspace) const {
  const float* from = workspace.activations_.front().data();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Layer& layer = layers_[i];
    float* to = workspace.activations_[i + 1].at_least(rows * layer.weight.n());
    multiply<float>({from, rows, layer.weight.k()}, layer.weight, to,
                    {layer.bias.data(), i + 1 < layers_.size(), nullptr});
    from = to;
  }
  return from;
}

}  // namespace lodestone::inference
