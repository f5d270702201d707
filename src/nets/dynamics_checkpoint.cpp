#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/dynamics.h"

namespace lodestone::nets {
namespace {

using common::CheckpointError;
using common::Json;

constexpr const char* kKind = "dynamics";

std::string member_part(std::size_t k) { return "member_" + std::to_string(k); }

const torch::Tensor& tensor_at(const Checkpoint& checkpoint, const std::string& part, const std::string& name,
                               const std::string& what) {
  const auto found = checkpoint.parts.find(part);
  if (found == checkpoint.parts.end() || found->second.count(name) == 0) {
    throw CheckpointError(what + ": tensor \"" + name + "\" of part \"" + part + "\" is missing");
  }
  return found->second.at(name);
}

DynamicsSplit split_from_json(const Json& json) {
  return {json.at("seed").get<std::uint64_t>(), json.at("validation_fraction").get<double>(),
          json.at("test_fraction").get<double>()};
}

}  // namespace

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

data::DatasetInfo dataset_info_from_json(const Json& json, const std::string& what) {
  try {
    data::DatasetInfo info;
    const auto layout = json.at("layout").get<std::string>();
    if (layout != "pose" && layout != "position") {
      throw CheckpointError(what + ": state layout \"" + layout + "\" is neither \"pose\" nor \"position\"");
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
    return info;
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": description of the dataset is malformed: " + error.what());
  }
}

void save_dynamics(const std::string& folder, const DynamicsModel& model, const Json& run_config,
                   const Json& metrics) {
  Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = run_config;
  checkpoint.facts["model"] = common::config_to_json(model.config);
  checkpoint.facts["dataset"] = dataset_info_to_json(model.info);
  checkpoint.facts["split"] = {{"seed", model.split.seed},
                               {"validation_fraction", model.split.validation_fraction},
                               {"test_fraction", model.split.test_fraction}};
  checkpoint.facts["units"] = {{"position", "m"}, {"heading", "rad"}, {"action", model.info.action_unit}};
  checkpoint.facts["metrics"] = metrics;
  for (std::size_t k = 0; k < model.members.size(); ++k) {
    checkpoint.parts[member_part(k)] = module_tensors(*model.members[k]);
  }
  NamedTensors rows;
  rows["start_states"] = model.start_states;
  rows["state"] = model.training_rows.state;
  rows["action"] = model.training_rows.action;
  rows["next_state"] = model.training_rows.next_state;
  for (const auto& [name, tensor] : rows) LODESTONE_CHECK(tensor.defined(), "the model lacks its " + name);
  checkpoint.parts["rows"] = std::move(rows);
  save_checkpoint(folder, checkpoint);
}

DynamicsModel load_dynamics(const std::string& folder) {
  const Checkpoint checkpoint = load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  DynamicsModel model;
  try {
    model.config = common::config_from_json<DynamicsConfig>(checkpoint.facts.at("model"), what);
    model.info = dataset_info_from_json(checkpoint.facts.at("dataset"), what);
    model.split = split_from_json(checkpoint.facts.at("split"));
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": shape of the networks is malformed: " + error.what());
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.config.members); ++k) {
    const auto part = checkpoint.parts.find(member_part(k));
    if (part == checkpoint.parts.end())
      throw CheckpointError(what + ": part \"" + member_part(k) + "\" is missing");
    DynamicsNetwork member(model.config, model.info.layout);
    load_module_tensors(*member, part->second, what + ", " + member_part(k));
    member->eval();
    model.members.push_back(member);
  }
  model.start_states = tensor_at(checkpoint, "rows", "start_states", what);
  model.training_rows.state = tensor_at(checkpoint, "rows", "state", what);
  model.training_rows.action = tensor_at(checkpoint, "rows", "action", what);
  model.training_rows.next_state = tensor_at(checkpoint, "rows", "next_state", what);
  return model;
}

}  // namespace lodestone::nets
