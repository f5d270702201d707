#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::runs {

/// Where the cells behind a figure were run.
struct CellOrigin {
  std::int64_t n_seeds = 0, n_seeds_planned = 0;
  std::vector<std::string> commits, processors;  ///< in order of appearance

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("n_seeds", n_seeds);
    v.field("n_seeds_planned", n_seeds_planned);
    v.field("commits", commits);
    v.field("processors", processors);
  }
};

/// Errors of one task under one controller over training seeds: the distance at the end of a trial, or the
/// cross-track RMS of one. Intervals are 95 %, by drawing seeds and, in them, trials anew (each is on a rig
/// of its own); that of success is no narrower than Wilson's. What only paths have, as means over the trials,
/// is absent for points.
struct PooledErrors {
  double mean_error_mm = 0.0, std_error_mm = 0.0, median_error_mm = 0.0;
  std::array<double, 2> mean_interval_mm = {};
  double success_rate = 0.0;
  std::array<double, 2> success_interval = {};
  std::optional<double> target_deviation_mm, target_deviation_std_mm;  ///< the paper's measure of a path
  std::optional<std::array<double, 2>> target_deviation_interval_mm;
  std::optional<double> time_rms_error_mm, completion, corners_reached;
  std::optional<std::array<double, 2>> time_rms_interval_mm, completion_interval, corners_interval;
  /// Mean difference on the same trials from a reference; negative is closer. Of Table II that is the bare
  /// baseline, of an open choice the chosen one, of an ablation the best preset; absent for these themselves.
  std::optional<double> from_reference_mm;
  std::optional<std::array<double, 2>> from_reference_interval_mm;
  std::optional<double> target_deviation_from_reference_mm;  ///< the same of that measure, of paths
  std::optional<std::array<double, 2>> target_deviation_from_reference_interval_mm;
  std::int64_t n_shared_trials = 0;  ///< of those differences
  std::int64_t n_trials = 0, n_stopped = 0;
  CellOrigin origin;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mean_error_mm", mean_error_mm);
    v.field("std_error_mm", std_error_mm);
    v.field("median_error_mm", median_error_mm);
    v.field("mean_interval_mm", mean_interval_mm);
    v.field("success_rate", success_rate);
    v.field("success_interval", success_interval);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("target_deviation_std_mm", target_deviation_std_mm);
    v.field("target_deviation_interval_mm", target_deviation_interval_mm);
    v.field("time_rms_error_mm", time_rms_error_mm);
    v.field("completion", completion);
    v.field("corners_reached", corners_reached);
    v.field("time_rms_interval_mm", time_rms_interval_mm);
    v.field("completion_interval", completion_interval);
    v.field("corners_interval", corners_interval);
    v.field("from_reference_mm", from_reference_mm);
    v.field("from_reference_interval_mm", from_reference_interval_mm);
    v.field("target_deviation_from_reference_mm", target_deviation_from_reference_mm);
    v.field("target_deviation_from_reference_interval_mm", target_deviation_from_reference_interval_mm);
    v.field("n_shared_trials", n_shared_trials);
    v.field("n_trials", n_trials);
    v.field("n_stopped", n_stopped);
    origin.visit(v);
  }
};

/// A mean with its interval, as those of PooledErrors.
struct PooledMean {
  double mean = 0.0;
  std::array<double, 2> interval = {};

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mean", mean);
    v.field("interval", interval);
  }
};

/// One controller minus another, on the same trials of the seeds that both have.
struct PairedErrors {
  PooledMean error_mm, success_rate;
  std::optional<PooledMean> target_deviation_mm;  ///< of paths
  std::int64_t n_trials = 0, n_seeds = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("error_mm", error_mm);
    v.field("success_rate", success_rate);
    v.field("target_deviation_mm", target_deviation_mm);
    v.field("n_trials", n_trials);
    v.field("n_seeds", n_seeds);
  }
};

/// How learning went, means over training seeds (Table I, Fig. 5). Intervals: 95 %, Student's over seeds;
/// absent of one. Ranges: of the lowest and the highest seed.
struct PooledTraining {
  double env_steps = 0.0;
  std::optional<double> train_seconds;  ///< of the seeds that learned on one thread
  std::int64_t n_timed = 0;             ///< those seeds
  double final_return = 0.0;            ///< of the last evaluation
  std::optional<std::array<double, 2>> final_return_interval;
  double lowest_return = 0.0, highest_return = 0.0;  ///< of all evaluations
  double success_rate = 0.0;  ///< of the policy that was kept, in fresh episodes of its own simulator
  std::array<double, 2> success_range = {};
  double unsteadiness = 0.0;  ///< standard deviation of the returns in the last fifth, mean over seeds
  std::array<double, 2> unsteadiness_range = {};
  std::int64_t n_converged = 0;  ///< seeds whose return had stopped rising
  std::int64_t n_fallen = 0;     ///< seeds whose return ended by more than 5 % of its rise below its maximum
  std::vector<std::string> products;        ///< of matrices, as their seeds computed them
  std::optional<double> success_radius_mm;  ///< of the task that it learned
  /// Until the return was within 5 % of its rise below its maximum; absent unless every seed had converged.
  /// Seconds: as above.
  std::optional<double> seconds_to_maximum, steps_to_maximum;
  std::optional<std::array<double, 2>> steps_to_maximum_range;
  CellOrigin origin;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("env_steps", env_steps);
    v.field("train_seconds", train_seconds);
    v.field("n_timed", n_timed);
    v.field("final_return", final_return);
    v.field("final_return_interval", final_return_interval);
    v.field("lowest_return", lowest_return);
    v.field("highest_return", highest_return);
    v.field("success_rate", success_rate);
    v.field("success_range", success_range);
    v.field("unsteadiness", unsteadiness);
    v.field("unsteadiness_range", unsteadiness_range);
    v.field("n_converged", n_converged);
    v.field("n_fallen", n_fallen);
    v.field("products", products);
    v.field("success_radius_mm", success_radius_mm);
    v.field("seconds_to_maximum", seconds_to_maximum);
    v.field("steps_to_maximum", steps_to_maximum);
    v.field("steps_to_maximum_range", steps_to_maximum_range);
    origin.visit(v);
  }
};

/// How fast a training is that has the machine to itself, on one thread (Table I), after warming up.
struct TrainingPace {
  double warm_up_steps = 0.0, warm_up_s = 0.0;  ///< begin, and the time that took
  double steps_per_s =
      0.0;  ///< afterwards, of the environments, with the updates and evaluations that go with them
  double processor_share = 0.0;       ///< of that time, on a processor
  std::optional<double> others;       ///< processors that others kept busy meanwhile, on average
  std::vector<std::string> products;  ///< of matrices; none where nothing says
  CellOrigin origin;

  /// Time on the clock that so many steps take from the start.
  double seconds_to(double steps) const {
    if (steps < warm_up_steps) return warm_up_s * steps / warm_up_steps;
    return warm_up_s + (steps - warm_up_steps) / steps_per_s;
  }

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("warm_up_steps", warm_up_steps);
    v.field("warm_up_s", warm_up_s);
    v.field("steps_per_s", steps_per_s);
    v.field("processor_share", processor_share);
    v.field("others", others);
    v.field("products", products);
    origin.visit(v);
  }
};

/// One training against another (a mix against none, Fig. 5; an open choice against the chosen one), over the
/// seeds that both have: of a seed both learn in the same simulator.
struct TrainingDifference {
  double final_return = 0.0;                                   ///< mean difference
  std::optional<std::array<double, 2>> final_return_interval;  ///< 95 %, Student's over seeds; absent of one
  double unsteadiness = 0.0, unsteadiness_of_other = 0.0;      ///< PooledTraining::unsteadiness
  std::optional<double> steps_to_maximum, steps_to_maximum_of_other;
  std::int64_t n_seeds = 0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("final_return", final_return);
    v.field("final_return_interval", final_return_interval);
    v.field("unsteadiness", unsteadiness);
    v.field("unsteadiness_of_other", unsteadiness_of_other);
    v.field("steps_to_maximum", steps_to_maximum);
    v.field("steps_to_maximum_of_other", steps_to_maximum_of_other);
    v.field("n_seeds", n_seeds);
  }
};

/// A learned simulator (section V-A), means over training seeds, with 95 % intervals by Student's t; absent
/// of one.
struct PooledDynamics {
  /// Distance in units of the data's spread; that of validation is absent where likelihood was learned.
  std::optional<double> validation_loss;
  std::optional<std::array<double, 2>> validation_loss_interval;
  double test_loss = 0.0;
  std::optional<std::array<double, 2>> test_loss_interval;
  double position_rms_mm = 0.0;
  std::optional<std::array<double, 2>> position_rms_interval_mm;
  /// On the same pulses: nothing moves, and ten nearest neighbours.
  std::optional<double> no_motion_mm, neighbours_mm;
  std::optional<double> heading_rms_deg;
  std::optional<std::array<double, 2>> heading_rms_interval_deg;
  CellOrigin origin;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("validation_loss", validation_loss);
    v.field("validation_loss_interval", validation_loss_interval);
    v.field("test_loss", test_loss);
    v.field("test_loss_interval", test_loss_interval);
    v.field("position_rms_mm", position_rms_mm);
    v.field("position_rms_interval_mm", position_rms_interval_mm);
    v.field("no_motion_mm", no_motion_mm);
    v.field("neighbours_mm", neighbours_mm);
    v.field("heading_rms_deg", heading_rms_deg);
    v.field("heading_rms_interval_deg", heading_rms_interval_deg);
    origin.visit(v);
  }
};

/// `report.json` of the paper's experiments. Keys of the maps are those of the cells.
struct PaperResult {
  static constexpr const char* kFile = "report.json";
  std::string scale;
  std::int64_t n_cells = 0, n_cells_planned = 0;
  std::vector<std::string> machines, commits, dates;
  double cell_hours = 0.0;  ///< of all cells, one after another
  std::map<std::string, std::map<std::string, std::map<std::string, PooledErrors>>>
      transfer;  ///< row, variant, task
  /// A row that learned in a learned simulator minus its like that did in the plain one: row, variant, task.
  std::map<std::string, std::map<std::string, std::map<std::string, PairedErrors>>> learned_minus_plain;
  std::map<std::string, std::map<std::string, PooledTraining>> training;  ///< row, task
  std::map<std::string, std::map<std::string, TrainingPace>> paces;       ///< row, task
  std::map<std::string, PooledDynamics> dynamics;
  std::map<std::string, PooledTraining> mixes;                ///< environments that replay, or "offline"
  std::map<std::string, TrainingDifference> mix_differences;  ///< of 1 to 3 environments from none
  std::map<std::string, std::map<std::string, PooledErrors>> open_choices;  ///< choice, task
  std::map<std::string, PooledTraining> open_trainings;                     ///< choice, or choice and mix
  std::map<std::string, TrainingDifference> open_differences;            ///< the same, from what was chosen
  std::map<std::string, std::map<std::string, PooledErrors>> ablations;  ///< name, task
  std::map<std::string, PooledTraining> ablation_trainings;              ///< name

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("scale", scale);
    v.field("n_cells", n_cells);
    v.field("n_cells_planned", n_cells_planned);
    v.field("machines", machines);
    v.field("commits", commits);
    v.field("dates", dates);
    v.field("cell_hours", cell_hours);
    v.field("transfer", transfer);
    v.field("learned_minus_plain", learned_minus_plain);
    v.field("training", training);
    v.field("paces", paces);
    v.field("dynamics", dynamics);
    v.field("mixes", mixes);
    v.field("mix_differences", mix_differences);
    v.field("open_choices", open_choices);
    v.field("open_trainings", open_trainings);
    v.field("open_differences", open_differences);
    v.field("ablations", ablations);
    v.field("ablation_trainings", ablation_trainings);
  }
};

}  // namespace lodestone::runs
