#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/data/dataset.h"
#include "lodestone/nets/dynamics.h"

namespace lodestone::rl {

/// Root-mean-square errors of predicted next states.
struct StateError {
  double position_rms_mm = 0.0;           ///< of the distance between predicted and recorded position
  std::optional<double> heading_rms_deg;  ///< wrapped; none where the state has no heading
};

/// One square of the dish: the one-step error of the rows that start in it.
struct ErrorCell {
  double x_m = 0.0;  ///< its centre
  double y_m = 0.0;
  double rms_mm = 0.0;
  std::int64_t n = 0;
};

/// How well an ensemble's mean predicts recorded transitions (section V-A, and more).
struct DynamicsEvaluation {
  std::int64_t n = 0;  ///< rows with current
  StateError one_step;
  double normalised_l2 = 0.0;  ///< mean squared error in the networks' own normalised output
  double normalised_state_l2 =
      0.0;  ///< likewise, next state over its standard deviation in training: any form
  std::map<int, std::optional<double>>
      k_step_mm;                     ///< open-loop position RMS; none when no episode is that long
  StateError no_motion;              ///< baseline: the next state is the state
  StateError nearest_neighbours;     ///< baseline: mean motion of the ten nearest training rows
  std::vector<ErrorCell> error_map;  ///< squares of 5 mm that hold rows
};

/// Rows of `dataset` as evaluation uses them. Open-loop chains stay within episodes and leave zero-current
/// pulses without motion, as the MBS does. Throws DataError when the dataset has another state layout or no
/// row.
DynamicsEvaluation evaluate_dynamics(nets::DynamicsModel& model, const data::Dataset& dataset);

/// The episodes set aside when the model was trained ("test"), or all ("all").
data::Dataset select_split(const nets::DynamicsModel& model, const data::Dataset& dataset,
                           const std::string& split);

/// Keys position_rms_mm, heading_rms_deg, normalised_l2, normalised_state_l2, k_step, baselines, n,
/// error_map.
common::Json to_json(const DynamicsEvaluation& evaluation);

}  // namespace lodestone::rl
