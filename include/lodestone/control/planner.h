#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/control/controller.h"
#include "lodestone/control/foresight.h"
#include "lodestone/control/learned_simulator.h"
#include "lodestone/inference/cost_to_go.h"

namespace lodestone::control {

/// How far and how hard a planner looks ahead.
struct PlannerConfig {
  std::int64_t horizon = 1;
  std::int64_t candidates = 48;
  std::int64_t elites = 6;
  std::int64_t iterations = 3;
  std::int64_t particles = 8;
  double spread = 0.5;
  double current_cost = 0.02;
  double goal_radius_m = 0.0003;
  double heading_cost_mm = 5.0;
  double along_slack_m = 0.003;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("horizon", horizon, "pulses", "how far ahead", {1, 50});
    v.field("candidates", candidates, "", "sequences of actions tried in every iteration", {4, 100000});
    v.field("elites", elites, "", "best of them, around which the next iteration looks", {1, 100000});
    v.field("iterations", iterations, "", "rounds of narrowing down", {1, 100});
    v.field(
        "particles", particles, "",
        "outcomes that every sequence is judged by; where nothing differs between them, one for each member "
        "of the ensemble",
        {1, 1000});
    v.field("spread", spread, "action units", "standard deviation of the first round", {1e-3, 2.0});
    v.field("current_cost", current_cost, "mm", "cost of a pulse per squared action", {0.0, 1000.0});
    v.field("goal_radius_m", goal_radius_m, "m", "closer than this is no better", {0.0, 0.1});
    v.field(
        "heading_cost_mm", heading_cost_mm, "mm/rad",
        "cost of a heading error, where the target has a heading; where it moves, too, root of the sum of "
        "squares with that of the distance",
        {0.0, 1000.0});
    v.field("along_slack_m", along_slack_m, "m",
            "where the target moves and has a heading: so far ahead of it or behind is no worse", {0.0, 0.1});
  }
  /// Throws ConfigError.
  void validate() const;
};

/// Plans anew at every step by the cross-entropy method (Rubinstein; Chua et al., PETS, 2018): tries
/// sequences of pulses as a simulator has them, keeps the best, looks around them again, and gives the first
/// pulse of the one that is best on outcomes that none was chosen by. The cost is the mean distance over the
/// horizon to where the target will be, and to how the needle shall lie there (along a path a needle that is
/// a little early or late may lie better: PlannerConfig::along_slack_m), over particles: each has a
/// member of the ensemble, luck that is the same for every sequence, and where the rig is identified a gain
/// of the drive; a flow that was identified carries them all. Before it rests short of a target that stays,
/// it looks for a pulse that may bring the needle nearer, whatever else it may do: from elsewhere it can be
/// tried again.
///
/// Where the target is to stay at and a cost-to-go was learned (inference::CostToGo), sequences are judged by
/// that instead: what lying there costs, pulse by pulse, and at the end all that comes after. The first round
/// then tries pulses of every strength, as a needle turns at a tenth of what moves it, and later ones look
/// around each of the best: the mean of two ways to a pose lies on neither. Where its pulses move nothing, a
/// place becomes dearer. A needle that is waited for (task::Observation::awaited) is not left lying, unless
/// every pulse costs as much as never coming near. A target without a heading is gone to by the distance
/// until no pulse is found that brings the needle nearer, from then on by the cost-to-go, to the heading
/// there that costs least; and wherever it would rest by that, but not well within the tolerance, by the
/// distance again.
class Planner final : public Controller {
 public:
  /// `cost_to_go`: null where none was learned.
  Planner(std::shared_ptr<Foresight> foresight, const PlannerConfig& config, std::uint64_t seed,
          std::shared_ptr<const inference::CostToGo> cost_to_go = nullptr);
  /// In a learned simulator.
  Planner(std::shared_ptr<const LearnedSimulator> model, const PlannerConfig& config, std::uint64_t seed,
          std::shared_ptr<const inference::CostToGo> cost_to_go = nullptr);
  void reset() override;
  geometry::Drive act(const task::Observation& observation) override;
  std::unique_ptr<Controller> clone() const override;

 private:
  using Sequence = std::vector<geometry::Drive>;  // [horizon]

  /// The best sequence that is found, by the cost-to-go or by the distance.
  Sequence searched(const task::Observation& observation);
  /// The pose that costs least of those the target allows.
  geometry::Pose2 cheapest_goal(const task::Observation& observation);
  /// The candidates of a round, by the mean and spread of the best ones of the round before,
  void look_around(const Sequence& mean, const Sequence& spread);
  /// or around each of them; without any, everywhere.
  void look_around(const std::vector<Sequence>& elites, std::int64_t round);
  /// To where pulse `t` takes a needle, [S], and a flow carries it that the pulse moves.
  void move(const task::Observation& observation, std::size_t t, const double* next, double* state) const;
  /// Mean cost of every candidate over the particles: in mm, or in pulses by the cost-to-go.
  void evaluate_candidates(const task::Observation& observation);
  /// What rows of states cost after pulse `t` of the horizon, for each candidate.
  void add_distances(const task::Observation& observation, std::size_t t, double fraction);
  void add_pose_costs(std::size_t t, double fraction);
  /// Makes the place dearer where the needle lies as before although it was given a pulse, by that cost.
  void note_stillness(const task::Observation& observation);
  /// Indices of the `count` best candidates, best first.
  std::vector<std::size_t> best(std::size_t count) const;

  std::shared_ptr<Foresight> foresight_;
  PlannerConfig config_;
  std::uint64_t seed_;
  common::RandomStream random_;
  Sequence plan_;  // of the step before
  std::vector<Sequence> candidates_;
  std::vector<double> cost_;                  // [candidates]
  std::vector<double> quantile_;              // [particles], of a normal number
  std::vector<double> state_, drive_, next_;  // rows by particle, then candidate
  std::shared_ptr<const inference::CostToGo> cost_to_go_;
  /// Where pulses moved nothing, and how much dearer than learned it is to lie there.
  struct Dearer {
    geometry::Pose2 pose;
    double cost = 0.0;
  };
  double most_mm_ = std::numeric_limits<double>::infinity();  // no place is dearer, by the distance
  bool by_cost_to_go_ = false;                                // is searched
  geometry::Pose2 goal_;                                      // then
  bool led_no_further_ = false;                               // the distance, to this target
  std::optional<geometry::Pose2> pose_before_;
  geometry::Vector2 target_before_m_ = geometry::Vector2::Zero();
  std::optional<double> target_heading_before_rad_;
  std::vector<Dearer> dearer_;
  std::vector<double> row_cost_;
  inference::CostToGo::Workspace judge_;
};

}  // namespace lodestone::control
