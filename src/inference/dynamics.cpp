#include "lodestone/inference/dynamics.h"

#include <algorithm>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::inference {
namespace {

using common::CheckpointError;
using common::Json;

std::vector<task::Move> moves_between(const Array& from, const Array& to, std::size_t state_size) {
  const std::vector<double> before = from.to_double();
  const std::vector<double> after = to.to_double();
  std::vector<task::Move> moves;
  for (std::size_t i = 0; i + state_size <= before.size() && i + state_size <= after.size(); i += state_size)
    moves.push_back({{before[i], before[i + 1]}, {after[i], after[i + 1]}});
  return moves;
}

}  // namespace

std::string member_part(std::size_t member) { return "member_" + std::to_string(member); }

void predict_mean(const std::vector<FoldedDynamics>& members, const double* state, const double* drive,
                  std::int64_t rows, double* next, std::vector<double>& one_member,
                  FoldedDynamics::Workspace& workspace) {
  LODESTONE_CHECK(!members.empty(), "the ensemble has no member");
  const auto size = static_cast<std::size_t>(members.front().state_size());
  const std::size_t count = static_cast<std::size_t>(rows) * size;
  const double fraction = 1.0 / static_cast<double>(members.size());
  std::fill_n(next, count, 0.0);
  one_member.resize(count);
  for (const FoldedDynamics& member : members) {
    member.predict(state, drive, rows, one_member.data(), workspace);
    for (std::size_t k = 0; k < count; ++k) {
      const bool heading = size == 3 && k % 3 == 2;
      const double change = one_member[k] - state[k];
      next[k] += fraction * (heading ? geometry::wrap_angle(change) : change);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    next[k] += state[k];
    if (size == 3 && k % 3 == 2) next[k] = geometry::wrap_angle(next[k]);
  }
}

DynamicsConfig dynamics_config_of(const Json& facts, const std::string& what) {
  try {
    return common::config_from_json<DynamicsConfig>(facts.at("model"), what);
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": shape of the networks is malformed: " + error.what());
  }
}

data::DatasetInfo dataset_info_of(const Json& facts, const std::string& what) {
  if (!facts.is_object() || !facts.contains("dataset"))
    throw CheckpointError(what + ": says nothing of the dataset that it was trained on");
  try {
    data::DatasetInfo info = data::info_from_json(facts.at("dataset"), what);
    data::check_info(info, what);
    return info;
  } catch (const common::DataError& error) {
    throw CheckpointError(error.what());
  }
}

const Array& training_rows(const Checkpoint& checkpoint, const std::string& name, std::int64_t columns,
                           const std::string& what) {
  const Array& rows = checkpoint.at("rows", name, what);
  const std::string where = what + ": array \"" + name + "\" of part \"rows\"";
  const bool numbers = rows.type() == ElementType::kFloat32 || rows.type() == ElementType::kFloat64;
  if (!numbers || rows.shape().size() != 2 || rows.shape()[0] < 1 || rows.shape()[1] != columns)
    throw CheckpointError(where + " is " + rows.text() + ", expected rows of " + std::to_string(columns));
  check_finite(rows, where);
  return rows;
}

DynamicsModel load_dynamics(const std::string& folder) {
  const Checkpoint checkpoint = load_checkpoint(folder, "dynamics");
  const std::string what = "checkpoint " + folder;
  DynamicsModel model;
  model.config = dynamics_config_of(checkpoint.facts, what);
  model.info = dataset_info_of(checkpoint.facts, what);
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.config.members); ++k) {
    const auto part = checkpoint.parts.find(member_part(k));
    if (part == checkpoint.parts.end())
      throw CheckpointError(what + ": part \"" + member_part(k) + "\" is missing");
    model.members.emplace_back(part->second, model.config, model.info.rows(), what + ", " + member_part(k));
  }
  const int size = data::state_size(model.info.layout);
  model.start_states = training_rows(checkpoint, "start_states", size, what).to_double();
  model.recorded_moves =
      moves_between(training_rows(checkpoint, "state", size, what),
                    training_rows(checkpoint, "next_state", size, what), static_cast<std::size_t>(size));
  return model;
}

}  // namespace lodestone::inference
