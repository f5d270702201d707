#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/array.h"
#include "lodestone/inference/dense_network.h"

namespace lodestone::inference {

/// Layers "l<first>.weight" [outputs, inputs], "l<first>.bias" [outputs], ... as checkpoints hold them, for
/// widths from input to output. Throws CheckpointError that begins with `what` when one is missing or of
/// another shape.
std::vector<LinearLayer> layers_from(const Arrays& weights, const std::vector<std::int64_t>& widths,
                                     int first, const std::string& what);

/// Actor of section IV-B2 for evaluation: D -> hidden (ReLU) -> A, tanh. Read only, so threads share it.
class Actor {
 public:
  using Workspace = DenseNetwork::Workspace;

  /// Layers l1, l2, ... Throws CheckpointError that begins with `what`.
  Actor(const Arrays& weights, std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
        std::int64_t action_size = 2, const std::string& what = "actor");

  std::int64_t observation_size() const { return network_.inputs(); }
  std::int64_t action_size() const { return network_.outputs(); }
  /// `observation` [rows, D] -> `action` [rows, A] in [-1, 1].
  void act(const float* observation, std::int64_t rows, float* action, Workspace& workspace) const;

 private:
  DenseNetwork network_;
};

/// Twin critics for evaluation, each (D + A) -> hidden (ReLU) -> 1.
class TwinCritic {
 public:
  using Workspace = DenseNetwork::Workspace;

  /// First critic l1, l2, ..., the second with the numbers that follow. Throws as Actor does.
  TwinCritic(const Arrays& weights, std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
             std::int64_t action_size = 2, const std::string& what = "critic");

  /// `observation` [rows, D], `action` [rows, A] -> `first` and `second` [rows].
  void evaluate(const float* observation, const float* action, std::int64_t rows, float* first, float* second,
                Workspace& workspace) const;

 private:
  std::int64_t observation_size_;
  std::int64_t action_size_;
  DenseNetwork first_, second_;
};

}  // namespace lodestone::inference
