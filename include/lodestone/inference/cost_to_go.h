#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/inference/array.h"
#include "lodestone/inference/dense_network.h"

namespace lodestone::inference {

/// What it costs to lie somewhere else than at a wanted pose, pulse by pulse.
struct PoseCost {
  double tolerance_m = 0.001;
  double tolerance_deg = 5.0;
  double discount = 0.97;
  double current_cost = 0.02;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("tolerance_m", tolerance_m, "m",
            "a pulse after which the needle lies this far off costs 1 - 1/e, one far from the target 1",
            {1e-5, 1.0});
    v.field("tolerance_deg", tolerance_deg, "deg", "or is turned away by this", {0.1, 180.0});
    v.field("discount", discount, "", "a cost counts so much less for every pulse that it is ahead",
            {0.0, 0.999});
    v.field("current_cost", current_cost, "", "cost of a pulse per squared action", {0.0, 1.0});
  }

  /// Beyond it everything costs most(). No key: it is the reach of the data that were learned from.
  double dish_radius_m = 0.0;

  /// Within 0 .. 1: 1 - exp(-r^4), r^2 = (d / tolerance_m)^2 + (turn / tolerance)^2. So well within both
  /// there is little to gain, and a needle is left alone.
  double at(const geometry::Pose2& pose, const geometry::Pose2& goal) const;
  /// Nearer to the goal than this share of the one tolerance, and turned away by less than that of the other.
  bool within(double share, const geometry::Pose2& pose, const geometry::Pose2& goal) const;
  /// Of all pulses to come, where none ever comes near.
  double most() const { return 1.0 / (1.0 - discount); }
  /// Of all pulses to come, where the needle is left lying for good. A pulse is worth while if it comes to
  /// less: where it does, waiting with it never pays.
  double of_staying(const geometry::Pose2& pose, const geometry::Pose2& goal) const;

 private:
  struct Off {
    double away, turned;  // in tolerances
  };
  Off off(const geometry::Pose2& pose, const geometry::Pose2& goal) const;
};

/// What bringing a needle to a pose costs from here on, in pulses: the expected sum of PoseCost over all
/// pulses to come, as a network has learned it (rl::ValueIterationLearner). Read only, so threads share it.
class CostToGo {
 public:
  using Workspace = DenseNetwork::Workspace;
  static constexpr std::int64_t kFeatures = 15;

  /// Layers "l1.weight" [outputs, inputs], "l1.bias", ... from kFeatures through `hidden` to one number.
  /// Throws CheckpointError that begins with `what`.
  CostToGo(Arrays weights, std::vector<std::int64_t> hidden, const PoseCost& cost,
           const std::string& what = "cost-to-go");

  /// What the network takes of a pose and the goal: kFeatures numbers.
  static void write_features(const geometry::Pose2& pose, const geometry::Pose2& goal, double dish_radius_m,
                             float* out);

  /// Of needles that lie in `state` [rows, 3] (x_m, y_m, heading_rad) after a pulse: what lying there costs,
  /// and all that comes after it, which is never more than staying there costs; `cost` [rows], within
  /// 0 .. most(). Each goal belongs to `rows_per_goal` rows after one another.
  void evaluate(const double* state, const geometry::Pose2* goal, std::int64_t rows_per_goal,
                std::int64_t rows, double* cost, Workspace& workspace) const;

  const PoseCost& cost() const { return cost_; }
  const Arrays& weights() const { return weights_; }
  const std::vector<std::int64_t>& hidden() const { return hidden_; }

 private:
  Arrays weights_;
  std::vector<std::int64_t> hidden_;
  PoseCost cost_;
  DenseNetwork network_;
};

}  // namespace lodestone::inference
