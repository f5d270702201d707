#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/array.h"
#include "lodestone/inference/gemm.h"

namespace lodestone::inference {

/// More than any network here needs; a checkpoint that says more is refused before memory is taken for it.
constexpr std::int64_t kWidestLayer = 8192;
constexpr std::size_t kMostLayers = 16;

/// y = W x + b.
struct LinearLayer {
  std::vector<float> weight;  ///< [outputs, inputs], row-major
  std::vector<float> bias;    ///< [outputs]
};

/// Array `name` of `shape`, float32, every number finite. Throws CheckpointError that begins with `what`.
const Array& weight_at(const Arrays& weights, const std::string& name, const std::vector<std::int64_t>& shape,
                       const std::string& what);

/// Linear layers with ReLU in between, for evaluation only: the weights are packed once (gemm.h) and read
/// from then on, so threads share a network, each with its own Workspace. A row's result does not depend on
/// the others.
class DenseNetwork {
 public:
  /// Activations of one thread; grows to the largest batch seen.
  class Workspace {
    friend class DenseNetwork;
    std::vector<CacheAligned<float>> activations_;
  };

  /// At least one layer; each takes what the one before gives.
  explicit DenseNetwork(const std::vector<LinearLayer>& layers);

  std::int64_t inputs() const { return layers_.front().weight.k(); }
  std::int64_t outputs() const { return layers_.back().weight.n(); }

  /// Room for [rows, inputs], to be filled before forward().
  float* input(std::int64_t rows, Workspace& workspace) const;
  /// [rows, outputs], which stay in the workspace until the next call.
  const float* forward(std::int64_t rows, Workspace& workspace) const;

 private:
  struct Layer {
    PackedMatrix<float> weight;  ///< [inputs, outputs]
    std::vector<float> bias;
  };
  std::vector<Layer> layers_;
};

}  // namespace lodestone::inference
