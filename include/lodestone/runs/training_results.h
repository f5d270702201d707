#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::runs {

/// Figures of the deterministic policy over one episode per environment.
struct PolicyScore {
  double episode_return = 0.0;
  double success_rate = 0.0;  ///< fraction of episodes that were within the success radius at some step
  /// Mean distance to the goal when the episode ended: at the first arrival where that ends it, or when time
  /// was up. A deployment goes on after the arrival and measures after a fixed time instead.
  double episode_end_error_mm = 0.0;
  double episode_end_error_median_mm = 0.0;
  double episode_length = 0.0;
  double action_saturation = 0.0;  ///< fraction of action components beyond 0.95
  std::int64_t episodes = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("episode_return", episode_return);
    v.field("success_rate", success_rate);
    v.field("episode_end_error_mm", episode_end_error_mm);
    v.field("episode_end_error_median_mm", episode_end_error_median_mm);
    v.field("episode_length", episode_length);
    v.field("action_saturation", action_saturation);
    v.field("episodes", episodes);
  }
};

/// How much a policy was trained.
struct PolicyFacts {
  std::int64_t env_steps = 0;
  std::int64_t updates = 0;
  double train_seconds = 0.0;               ///< wall time of learning, interruptions left out
  std::optional<double> processor_seconds;  ///< of all threads meanwhile; absent in older runs
  /// What others used of the machine meanwhile (common::other_processor_seconds()).
  std::optional<double> other_processor_seconds;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("env_steps", env_steps);
    v.field("updates", updates);
    v.field("train_seconds", train_seconds);
    v.field("processor_seconds", processor_seconds);
    v.field("other_processor_seconds", other_processor_seconds);
  }
};

/// `result.json` of train-policy.
struct PolicyResult : PolicyFacts {
  static constexpr const char* kFile = "result.json";
  std::int64_t best_env_steps = 0;  ///< when the policy that was kept was reached
  /// Training time, evaluations included, until an evaluation first came 95 % of the way from the untrained
  /// policy's return to the last one's: the paper's Table I.
  double seconds_to_95_percent = 0.0;
  double peak_memory_mb = 0.0;  ///< of the whole program so far
  /// The policy that was kept, in the episodes that it was chosen by: the best of all evaluations, so it
  /// flatters; the latest, where a cost-to-go is learned beside it.
  std::optional<PolicyScore> best_evaluation;
  /// The same policy in as many episodes that nothing was chosen by, after training: the figure to quote.
  std::optional<PolicyScore> fresh_evaluation;
  std::optional<double> success_rate;  ///< of fresh_evaluation
  std::optional<std::string>
      products;  ///< of TD3: what was computed in ("float32", "bfloat16"); absent in older runs

  template <class Visitor>
  void visit(Visitor& v) {
    PolicyFacts::visit(v);
    v.field("best_env_steps", best_env_steps);
    v.field("seconds_to_95_percent", seconds_to_95_percent);
    v.field("peak_memory_mb", peak_memory_mb);
    v.field("best_evaluation", best_evaluation);
    v.field("fresh_evaluation", fresh_evaluation);
    v.field("success_rate", success_rate);
    v.field("products", products);
  }
};

/// Root-mean-square errors of predicted next states.
struct StateError {
  double position_rms_mm = 0.0;           ///< of the distance between predicted and recorded position
  std::optional<double> heading_rms_deg;  ///< wrapped; none where the state has no heading

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("position_rms_mm", position_rms_mm);
    v.field("heading_rms_deg", heading_rms_deg);
  }
};

/// Root-mean-square errors after several pulses, of which each but the first begins where the one before was
/// predicted to end, by their number; none where no episode is that long. Pulses without current count here.
struct OpenLoopError {
  static constexpr int kSteps[] = {1, 2, 5, 10};  ///< the numbers of pulses
  using BySteps = std::map<int, std::optional<double>>;
  std::optional<BySteps> k_step_mm = {};           ///< of the position
  std::optional<BySteps> k_step_heading_deg = {};  ///< wrapped; absent where the state has no heading

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("k_step", k_step_mm);
    v.field("k_step_heading_deg", k_step_heading_deg);
  }
};

/// The same of forecasts that are each the mean of many runs, every one of which draws what it meets, as
/// experiments::add_oracle's are.
struct DrawnOpenLoop {
  std::int64_t draws = 0;
  OpenLoopError model;               ///< a run is of one member, and draws from its distributions
  OpenLoopError nearest_neighbours;  ///< a run moves as any one of the ten did

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("draws", draws);
    v.field("model", model);
    v.field("knn10", nearest_neighbours);
  }
};

/// What a learned simulator is held against. What they are off by open loop is absent in older runs.
struct DynamicsBaselines {
  StateError no_motion;           ///< the next state is the state
  StateError nearest_neighbours;  ///< mean motion of the ten nearest training rows
  std::optional<OpenLoopError> no_motion_open_loop = {};
  std::optional<OpenLoopError> nearest_neighbours_open_loop = {};
  /// The virtual rig itself (experiments::add_oracle), where that was asked for.
  std::optional<StateError> oracle = {};
  std::optional<OpenLoopError> oracle_open_loop = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("no_motion", no_motion);
    v.field("knn10", nearest_neighbours);
    v.field("no_motion_open_loop", no_motion_open_loop);
    v.field("knn10_open_loop", nearest_neighbours_open_loop);
    v.field("oracle", oracle);
    v.field("oracle_open_loop", oracle_open_loop);
  }
};

/// A share of recorded motions, with Wilson's 95 % interval, which takes them as independent.
struct CoveredFraction {
  double fraction = 0.0;
  std::array<double, 2> interval = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("fraction", fraction);
    v.field("interval", interval);
  }
};

/// What shares of recorded motions lie inside the regions in which a distribution expects 50, 90 and 99 % of
/// them, by these per cent. One that is calibrated has shares of 0.5, 0.9 and 0.99; one that is too sure of
/// itself less.
struct RegionCoverage {
  using ByPercent = std::map<int, CoveredFraction>;
  std::int64_t n = 0;             ///< motions
  ByPercent position;             ///< wherever the heading went
  std::optional<ByPercent> pose;  ///< position and heading together; absent where the state has no heading

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("n", n);
    v.field("position", position);
    v.field("position_and_heading", pose);
  }
};

/// A learned simulator in numbers; as much as is known of it.
struct DynamicsFacts {
  StateError one_step;
  std::optional<double> normalised_l2;  ///< mean squared error in the networks' own normalised output
  OpenLoopError open_loop;
  std::optional<DynamicsBaselines> baselines;
  std::optional<RegionCoverage> region_coverage;  ///< absent where single values are predicted
  std::optional<std::int64_t> n;                  ///< rows with current

  template <class Visitor>
  void visit(Visitor& v) {
    one_step.visit(v);
    v.field("normalised_l2", normalised_l2);
    open_loop.visit(v);
    v.field("baselines", baselines);
    v.field("region_coverage", region_coverage);
    v.field("n", n);
  }
};

/// One square of the dish: the one-step error of the rows that start in it.
struct ErrorCell {
  double x_m = 0.0;  ///< its centre
  double y_m = 0.0;
  double rms_mm = 0.0;
  std::int64_t n = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("x_m", x_m);
    v.field("y_m", y_m);
    v.field("rms_mm", rms_mm);
    v.field("n", n);
  }
};

/// One pulse of the test episodes: the way of the needle along x and y, and the way that was predicted.
struct PredictedMotion {
  std::array<double, 2> moved_mm = {};
  std::array<double, 2> predicted_mm = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("moved_mm", moved_mm);
    v.field("predicted_mm", predicted_mm);
  }
};

/// How a network's training went.
struct TrainingFacts {
  double validation_loss = 0.0;
  double train_loss = 0.0;
  std::int64_t epochs = 0;
  double train_seconds = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("validation_loss", validation_loss);
    v.field("train_loss", train_loss);
    v.field("epochs", epochs);
    v.field("train_seconds", train_seconds);
  }
};

/// `evaluation.json` of train-dynamics: how well an ensemble's mean predicts recorded transitions (section
/// V-A, and more).
struct DynamicsEvaluation : DynamicsFacts {
  static constexpr const char* kFile = "evaluation.json";
  /// As normalised_l2, next state over its standard deviation in training: any form.
  std::optional<double> normalised_state_l2;
  std::vector<ErrorCell> error_map;                         ///< squares of 5 mm that hold rows
  std::optional<std::vector<PredictedMotion>> predictions;  ///< of some rows, evenly taken
  std::optional<std::string> split;                         ///< of the data: "test" or "all"
  std::optional<std::int64_t> transitions;                  ///< recorded, all splits together
  std::optional<DrawnOpenLoop> drawn_open_loop = {};        ///< where that was asked for
  std::optional<TrainingFacts> training;

  template <class Visitor>
  void visit(Visitor& v) {
    DynamicsFacts::visit(v);
    v.field("normalised_state_l2", normalised_state_l2);
    v.field("error_map", error_map);
    v.field("predictions", predictions);
    v.field("split", split);
    v.field("transitions", transitions);
    v.field("drawn_open_loop", drawn_open_loop);
    v.part("validation_loss", training);
  }
};

/// What was recorded: `summary.json` of collect.
struct CollectionFacts {
  static constexpr const char* kFile = "summary.json";
  std::int64_t transitions = 0;
  std::optional<std::int64_t> transitions_with_current;
  std::optional<double> coverage;
  std::optional<double> evenness;
  std::optional<std::int64_t> episodes;
  std::optional<std::int64_t> placements;  ///< of the needle, by the operator
  std::optional<double> placements_per_1000;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("transitions", transitions);
    v.field("transitions_with_current", transitions_with_current);
    v.field("coverage", coverage);
    v.field("evenness", evenness);
    v.field("episodes", episodes);
    v.field("placements", placements);
    v.field("placements_per_1000", placements_per_1000);
  }
};

/// What made a policy, as far as its checkpoint tells.
struct Provenance {
  std::optional<PolicyFacts> policy;
  std::optional<CollectionFacts> collect;
  std::optional<DynamicsFacts> dynamics;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("policy", policy);
    v.field("collect", collect);
    v.field("dynamics", dynamics);
  }
};

}  // namespace lodestone::runs
