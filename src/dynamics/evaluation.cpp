#include "lodestone/dynamics/evaluation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ATen/TensorOperators.h>
#include <ATen/core/grad_mode.h>

#include "lodestone/common/error.h"
#include "lodestone/data/knn.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/dynamics/region_coverage.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/nets/tensors.h"
#include "lodestone/physics/rig_description.h"
#include "open_loop.h"

namespace lodestone::dynamics {
namespace {

constexpr double kCell_m = 5e-3;
constexpr std::int64_t kNeighbours = 10;
constexpr std::int64_t kChunk = 8192;

/// Ensemble mean for rows of any number: [N, S], [N, A] -> [N, S], in pieces that stay in the cache.
std::vector<double> predict(const Model& model, const std::vector<double>& state,
                            const std::vector<double>& action) {
  const std::int64_t size = data::state_size(model.info.layout);
  const std::int64_t numbers = model.info.action_size;
  const auto rows = static_cast<std::int64_t>(action.size()) / numbers;
  const at::Tensor states = nets::tensor_from(state, {rows, size});
  const at::Tensor actions = nets::tensor_from(action, {rows, numbers});
  std::vector<double> next;
  next.reserve(state.size());
  for (std::int64_t first = 0; first < rows; first += kChunk) {
    const std::int64_t count = std::min(kChunk, rows - first);
    const auto part = nets::to_vector(
        predict_mean(model.members, states.narrow(0, first, count), actions.narrow(0, first, count)));
    next.insert(next.end(), part.begin(), part.end());
  }
  return next;
}

data::TransitionTable training_table(const Model& model) {
  data::TransitionTable table;
  table.state_size = data::state_size(model.info.layout);
  table.action_size = model.info.action_size;
  table.state = model.training_rows.state.to_double();
  table.action = model.training_rows.action.to_double();
  table.next_state = model.training_rows.next_state.to_double();
  table.episode.assign(table.action.size() / static_cast<std::size_t>(table.action_size), 0);
  return table;
}

/// Mean squared error of the members' mean output, normalised as in training.
double normalised_loss(const Model& model, const data::TransitionTable& table) {
  const at::NoGradGuard no_grad;
  const at::Tensor state = nets::tensor_from(table.state, {table.size(), table.state_size});
  const at::Tensor action = nets::tensor_from(table.action, {table.size(), table.action_size});
  const at::Tensor next = nets::tensor_from(table.next_state, {table.size(), table.state_size});
  double sum = 0.0;
  for (std::int64_t first = 0; first < table.size(); first += kChunk) {
    const std::int64_t rows = std::min(kChunk, table.size() - first);
    at::Tensor error;
    for (const auto& member : model.members) {
      const at::Tensor one =
          member->normalised_output(state.narrow(0, first, rows), action.narrow(0, first, rows)) -
          member->normalised_target(state.narrow(0, first, rows), next.narrow(0, first, rows));
      error = error.defined() ? error + one : one;
    }
    sum += (error / static_cast<double>(model.members.size())).square().sum().item<double>();
  }
  return sum / static_cast<double>(table.size() * table.state_size);
}

double normalised_state_loss(const Model& model, const std::vector<double>& predicted,
                             const data::TransitionTable& table) {
  const std::vector<double> spread =
      nets::to_vector(nets::to_tensor(model.training_rows.next_state).to(at::kDouble).std(0, false));
  const auto size = static_cast<std::size_t>(table.state_size);
  double sum = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    double error = predicted[i] - table.next_state[i];
    if (i % size == 2 && size == 3) error = geometry::wrap_angle(error);
    sum += std::pow(error / spread[i % size], 2);
  }
  return sum / static_cast<double>(predicted.size());
}

std::vector<ErrorCell> error_map(const data::TransitionTable& table, const std::vector<double>& predicted) {
  std::map<std::pair<std::int64_t, std::int64_t>, ErrorCell> cells;
  const auto size = static_cast<std::size_t>(table.state_size);
  for (std::size_t i = 0; i < predicted.size(); i += size) {
    const auto column = static_cast<std::int64_t>(std::floor(table.state[i] / kCell_m));
    const auto row = static_cast<std::int64_t>(std::floor(table.state[i + 1] / kCell_m));
    ErrorCell& cell = cells[{row, column}];
    cell.x_m = (static_cast<double>(column) + 0.5) * kCell_m;
    cell.y_m = (static_cast<double>(row) + 0.5) * kCell_m;
    cell.rms_mm += std::pow(predicted[i] - table.next_state[i], 2) +
                   std::pow(predicted[i + 1] - table.next_state[i + 1], 2);  // a sum, until below
    ++cell.n;
  }
  std::vector<ErrorCell> map;
  for (auto& entry : cells) {
    ErrorCell cell = entry.second;
    cell.rms_mm = geometry::kMmPerM * std::sqrt(cell.rms_mm / static_cast<double>(cell.n));
    map.push_back(cell);
  }
  return map;
}

/// Rows evenly taken, so that a chart of them can be read.
std::vector<runs::PredictedMotion> some_predictions(const data::TransitionTable& table,
                                                    const std::vector<double>& predicted) {
  constexpr std::int64_t kMost = 400;
  const std::int64_t stride = (table.size() + kMost - 1) / kMost;
  std::vector<runs::PredictedMotion> some;
  for (std::int64_t row = 0; row < table.size(); row += stride) {
    runs::PredictedMotion& motion = some.emplace_back();
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::size_t i = static_cast<std::size_t>(row * table.state_size) + axis;
      motion.moved_mm[axis] = geometry::kMmPerM * (table.next_state[i] - table.state[i]);
      motion.predicted_mm[axis] = geometry::kMmPerM * (predicted[i] - table.state[i]);
    }
  }
  return some;
}

}  // namespace

DynamicsEvaluation evaluate_dynamics(const Model& model, const data::Dataset& dataset) {
  if (dataset.info.layout != model.info.layout) {
    throw common::DataError("the data and the model describe different states: the model predicts " +
                            std::to_string(data::state_size(model.info.layout)) + " numbers, the data hold " +
                            std::to_string(data::state_size(dataset.info.layout)));
  }
  if (dataset.info.action_size != model.info.action_size)
    throw common::DataError("the data and the model are of different drives: the model knows actions of " +
                            std::to_string(model.info.action_size) + " numbers, the data hold " +
                            std::to_string(dataset.info.action_size));
  // Recordings of others may not say what they are of.
  if (dataset.info.rig.contains("drive") && model.info.rig.contains("drive")) {
    const std::string other = physics::other_drive(physics::completed_rig(model.info.rig),
                                                   physics::completed_rig(dataset.info.rig));
    if (!other.empty())
      throw common::DataError("the data and the model are of different drives: the model is of a rig with " +
                              other + " as in the data");
  }
  const data::TransitionTable table = data::flatten(dataset);
  if (table.size() == 0) throw common::DataError("there is no transition with current to evaluate on");
  for (const auto& member : model.members) member->train(false);

  const std::vector<double> predicted = predict(model, table.state, table.action);
  const data::NearestNeighbours neighbours(training_table(model), kNeighbours);
  DynamicsEvaluation evaluation;
  evaluation.n = table.size();
  evaluation.one_step = state_error(predicted, table.next_state, table.state_size);
  evaluation.normalised_l2 = normalised_loss(model, table);
  evaluation.normalised_state_l2 = normalised_state_loss(model, predicted, table);
  evaluation.open_loop = open_loop_error(
      [&](const auto& state, const auto& action) { return predict(model, state, action); }, dataset);
  runs::DynamicsBaselines& baselines = evaluation.baselines.emplace();
  baselines.no_motion = state_error(table.state, table.next_state, table.state_size);
  baselines.nearest_neighbours =
      state_error(neighbours.predict(table.state, table.action), table.next_state, table.state_size);
  baselines.no_motion_open_loop =
      open_loop_error([](const auto& state, const auto& /*action*/) { return state; }, dataset);
  baselines.nearest_neighbours_open_loop = open_loop_error(
      [&](const auto& state, const auto& action) { return neighbours.predict(state, action); }, dataset);
  evaluation.region_coverage = region_coverage(model, table);
  evaluation.error_map = error_map(table, predicted);
  evaluation.predictions = some_predictions(table, predicted);
  return evaluation;
}

void add_drawn_open_loop(const Model& model, const data::Dataset& dataset, std::int64_t draws,
                         DynamicsEvaluation& evaluation) {
  std::vector<inference::FoldedDynamics> members;
  for (const auto& member : model.members) members.push_back(fold(*member));
  const data::NearestNeighbours neighbours(training_table(model), kNeighbours);
  common::RandomStream model_draws(0, "forecasts of the model");
  common::RandomStream neighbour_draws(0, "forecasts of the neighbours");
  inference::FoldedDynamics::Workspace workspace;
  const auto size = static_cast<std::size_t>(data::state_size(model.info.layout));
  const auto numbers = static_cast<std::size_t>(model.info.action_size);
  const Predictor by_model = [&](const std::vector<double>& state, const std::vector<double>& action) {
    std::vector<double> next(state.size());
    common::RandomStream* const random = &model_draws;
    for (std::size_t i = 0; i < state.size() / size; ++i) {
      const inference::FoldedDynamics& member = members[i % static_cast<std::size_t>(draws) % members.size()];
      member.sample(&state[i * size], &action[i * numbers], 1, &random, &next[i * size], workspace);
    }
    return next;
  };
  const Predictor by_neighbours = [&](const auto& state, const auto& action) {
    return neighbours.sample(state, action, neighbour_draws);
  };
  evaluation.drawn_open_loop = {draws, open_loop_error(by_model, dataset, draws),
                                open_loop_error(by_neighbours, dataset, draws)};
}

data::Dataset test_split(const Model& model, const data::Dataset& dataset) {
  return data::split_by_episode(dataset, model.split.validation_fraction, model.split.test_fraction,
                                model.split.seed)
      .test;
}

}  // namespace lodestone::dynamics
