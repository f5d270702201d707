#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/inference/dense_network.h"

namespace lodestone::inference {

/// Actor of section IV-B2 for evaluation: D -> hidden (ReLU) -> A, tanh. Read only, so threads share it.
class Actor {
 public:
  using Workspace = DenseNetwork::Workspace;

  /// Layers "l1.weight" [outputs, inputs], "l1.bias" [outputs], "l2.weight", ... as checkpoints hold them.
  /// Throws CheckpointError that begins with `what`.
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
