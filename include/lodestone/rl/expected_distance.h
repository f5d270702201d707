#pragma once

#include <cstdint>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/inference/folded_dynamics.h"
#include "lodestone/rl/flat_network.h"

namespace lodestone::rl {

/// What a distance from a target is judged by.
struct DistanceCost {
  double goal_radius_m = 0.0;  ///< closer than this is no better
  double dish_radius_m = 0.0;  ///< what lies outside costs more than any way inside

  /// In mm, and its gradient by the position in mm/m.
  double at(const geometry::Vector2& position_m, const geometry::Vector2& target_m,
            geometry::Vector2* gradient = nullptr) const;
};

/// How far from its target a needle is expected to lie after a pulse, by a member of the learned simulator,
/// and the gradient of that by the drive. The expectation is a sum over the components of the predicted
/// mixture, each by its weight, of the mean over four points of each, which have its mean and covariance:
/// every part of it can be differentiated, and two pulses are compared by the same outcomes.
class ExpectedDistance {
 public:
  struct Workspace {
    FlatNetwork<float>::Workspace network;
    std::vector<float> features, raw_gradient;
  };

  /// `member` predicts a distribution; it must outlive this.
  ExpectedDistance(const inference::FoldedDynamics& member, const DistanceCost& cost);
  Workspace workspace(std::int64_t rows) const;

  /// For as many rows as the workspace has: `state` [rows, S], `drive` [rows, 2] in the dataset's unit,
  /// `target_m` [rows, 2] -> `cost_mm` [rows] and, unless null, `gradient` [rows, 2] in mm per unit of drive.
  /// The four points are turned by `turn_rad`.
  void evaluate(const double* state, const double* drive, const double* target_m, double turn_rad,
                double* cost_mm, double* gradient, Workspace& workspace) const;
  /// After evaluate(), one outcome of row `row` of it: where `state` [S] comes to, [S].
  void draw(std::int64_t row, const double* state, common::RandomStream& random, double* next,
            const Workspace& workspace) const;

 private:
  const inference::FoldedDynamics& member_;
  DistanceCost cost_;
  FlatNetwork<float> network_;
};

}  // namespace lodestone::rl
