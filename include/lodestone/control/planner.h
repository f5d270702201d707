#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/task/action.h"

namespace lodestone::control {

/// How far and how hard a planner looks ahead.
struct PlannerConfig {
  std::int64_t horizon = 4;
  std::int64_t candidates = 96;
  std::int64_t elites = 12;
  std::int64_t iterations = 3;
  double spread = 0.5;
  double current_cost = 0.02;
  double goal_radius_m = 0.001;
  double heading_cost_mm = 5.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("horizon", horizon, "pulses", "how far ahead", {1, 50});
    v.field("candidates", candidates, "", "sequences of actions tried in every iteration", {4, 100000});
    v.field("elites", elites, "", "best of them, around which the next iteration looks", {1, 100000});
    v.field("iterations", iterations, "", "rounds of narrowing down", {1, 100});
    v.field("spread", spread, "action units", "standard deviation of the first round", {1e-3, 2.0});
    v.field("current_cost", current_cost, "mm", "cost of a pulse per squared action", {0.0, 1000.0});
    v.field("goal_radius_m", goal_radius_m, "m", "closer than this is no better", {0.0, 0.1});
    v.field("heading_cost_mm", heading_cost_mm, "mm/rad",
            "cost of a heading error, where the target has a heading", {0.0, 1000.0});
  }
  /// Throws ConfigError.
  void validate() const;
};

/// A learned simulator ready for planning: shared by planners, read only.
struct PlannerModel {
  explicit PlannerModel(const inference::DynamicsModel& model);

  std::vector<inference::FoldedDynamics> members;
  std::size_t state_size;
  bool sampled;  ///< a distribution is predicted, so outcomes are drawn from it
  double dish_radius_m;
  task::ActionConfig action;
};

/// Plans anew at every step by the cross-entropy method (Rubinstein; Chua et al., PETS, 2018): tries
/// sequences of pulses in the learned simulator, one outcome per member of the ensemble, keeps the best,
/// looks around them again, and gives the first pulse of their mean. The cost is the mean distance over the
/// horizon to where the target will be.
class Planner final : public Controller {
 public:
  Planner(std::shared_ptr<const PlannerModel> model, const PlannerConfig& config, std::uint64_t seed);
  void reset() override;
  geometry::Vector2 act(const task::Observation& observation) override;

 private:
  /// Mean cost in mm of every candidate over the members.
  void evaluate_candidates(const task::Observation& observation);

  std::shared_ptr<const PlannerModel> model_;
  PlannerConfig config_;
  std::uint64_t seed_;
  common::RandomStream random_;
  std::vector<geometry::Vector2> plan_;        // [horizon], carried over from step to step
  std::vector<geometry::Vector2> candidates_;  // [candidates, horizon]
  std::vector<double> cost_mm_;                // [candidates]
  std::vector<double> state_, drive_, next_;   // rows by member, then candidate
  std::vector<common::RandomStream*> streams_;
  inference::FoldedDynamics::Workspace workspace_;
};

}  // namespace lodestone::control
