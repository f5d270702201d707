#include "lodestone/inference/dynamics.h"

#include "lodestone/common/error.h"
#include "lodestone/common/shown.h"

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

DynamicsConfig dynamics_config_of(const Json& facts, const std::string& what) {
  try {
    return common::config_from_json<DynamicsConfig>(facts.at("model"), what);
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": shape of the networks is malformed: " + error.what());
  }
}

Json dataset_info_to_json(const data::DatasetInfo& info) {
  Json json = Json::object();
  json["layout"] = info.layout == data::StateLayout::kPose ? "pose" : "position";
  json["action_unit"] = info.action_unit;
  json["action_scale"] = info.action_scale;
  json["workspace_radius_m"] = info.workspace_radius_m;
  json["one_axis_at_a_time"] = info.one_axis_at_a_time;
  json["control_period_s"] = info.control_period_s;
  json["seed"] = info.seed;
  json["source"] = info.source;
  json["rig"] = info.rig;
  return json;
}

data::DatasetInfo dataset_info_of(const Json& facts, const std::string& what) {
  try {
    const Json& json = facts.at("dataset");
    data::DatasetInfo info;
    const auto layout = json.at("layout").get<std::string>();
    if (layout != "pose" && layout != "position") {
      throw CheckpointError(what + ": state layout \"" + common::shown(layout) +
                            "\" is neither \"pose\" nor \"position\"");
    }
    info.layout = layout == "pose" ? data::StateLayout::kPose : data::StateLayout::kPosition;
    info.action_unit = json.at("action_unit").get<std::string>();
    info.action_scale = json.at("action_scale").get<double>();
    info.workspace_radius_m = json.at("workspace_radius_m").get<double>();
    info.one_axis_at_a_time = json.at("one_axis_at_a_time").get<bool>();
    info.control_period_s = json.at("control_period_s").get<double>();
    info.seed = json.at("seed").get<std::int64_t>();
    info.source = json.at("source").get<std::string>();
    info.rig = json.at("rig");
    data::check_info(info, what);
    return info;
  } catch (const common::DataError& error) {
    throw CheckpointError(error.what());
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": description of the dataset is malformed: " + error.what());
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
    model.members.emplace_back(part->second, model.config, model.info.layout, what + ", " + member_part(k));
  }
  const int size = data::state_size(model.info.layout);
  model.start_states = training_rows(checkpoint, "start_states", size, what).to_double();
  model.recorded_moves =
      moves_between(training_rows(checkpoint, "state", size, what),
                    training_rows(checkpoint, "next_state", size, what), static_cast<std::size_t>(size));
  return model;
}

}  // namespace lodestone::inference
