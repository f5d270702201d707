#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/geometry/drive.h"
#include "lodestone/inference/dense_network.h"

namespace lodestone::inference {

/// Actor of section IV-B2 for evaluation: D -> hidden (ReLU) -> A, tanh. Read only, so threads share it.
/// With `proposals` P above 0 the last layer proposes P actions, each by a direction (A numbers) and the
/// logarithm of its odds of strength, and has P + 1 scores, the last of which is for resting: the proposal
/// with the highest score is given, and exactly zero where that is resting.
class Actor {
 public:
  using Workspace = DenseNetwork::Workspace;

  /// Layers "l1.weight" [outputs, inputs], "l1.bias" [outputs], "l2.weight", ... as checkpoints hold them.
  /// Throws CheckpointError that begins with `what`.
  Actor(const Arrays& weights, std::int64_t observation_size, const std::vector<std::int64_t>& hidden,
        std::int64_t action_size = 2, const std::string& what = "actor", std::int64_t proposals = 0);

  std::int64_t observation_size() const { return network_.inputs(); }
  std::int64_t action_size() const { return action_size_; }
  /// `observation` [rows, D] -> `action` [rows, A] in [-1, 1].
  void act(const float* observation, std::int64_t rows, float* action, Workspace& workspace) const;
  /// All that an actor with proposals would do at one observation, from the highest score down: its
  /// proposals, and resting, zero. Of another one its only action. Throws LogicFault when the network
  /// answers with something that is not a finite number.
  std::vector<geometry::Drive> ranked(const float* observation, Workspace& workspace) const;

  /// Numbers of the last layer.
  static std::int64_t outputs(std::int64_t action_size, std::int64_t proposals) {
    return proposals == 0 ? action_size : (action_size + 2) * proposals + 1;
  }
  /// Which proposal has the highest score in a row of the last layer; `proposals` for resting.
  static std::int64_t choose(const float* output, std::int64_t action_size, std::int64_t proposals);
  /// Proposal `k` of a row: its direction times most_strength(A) / (1 + exp(-strength)), cut to [-1, 1]^A.
  static void propose(const float* output, std::int64_t action_size, std::int64_t k, float* action);
  /// Of an action: the corner of [-1, 1]^A.
  static double most_strength(std::int64_t action_size) {
    return std::sqrt(static_cast<double>(action_size));
  }

 private:
  std::int64_t action_size_;
  std::int64_t proposals_;
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
