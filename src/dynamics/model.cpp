#include "lodestone/dynamics/model.h"

#include "lodestone/common/error.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/dynamics.h"

namespace lodestone::dynamics {
namespace {

using common::CheckpointError;
using common::Json;
using inference::member_part;

constexpr const char* kKind = "dynamics";

DataSplit split_from_json(const Json& json) {
  return {json.at("seed").get<std::uint64_t>(), json.at("validation_fraction").get<double>(),
          json.at("test_fraction").get<double>()};
}

}  // namespace

void save_model(const std::string& folder, const Model& model, const Json& run_config, const Json& metrics) {
  inference::Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = run_config;
  checkpoint.facts["model"] = common::config_to_json(model.config);
  checkpoint.facts["dataset"] = inference::dataset_info_to_json(model.info);
  checkpoint.facts["split"] = {{"seed", model.split.seed},
                               {"validation_fraction", model.split.validation_fraction},
                               {"test_fraction", model.split.test_fraction}};
  checkpoint.facts["units"] = {{"position", "m"}, {"heading", "rad"}, {"action", model.info.action_unit}};
  checkpoint.facts["metrics"] = metrics;
  for (std::size_t k = 0; k < model.members.size(); ++k) {
    checkpoint.parts[member_part(k)] = nets::to_arrays(model.members[k]->tensors().named());
  }
  checkpoint.parts["rows"] = {{"start_states", model.start_states},
                              {"state", model.training_rows.state},
                              {"action", model.training_rows.action},
                              {"next_state", model.training_rows.next_state}};
  for (const auto& [name, rows] : checkpoint.parts["rows"])
    LODESTONE_CHECK(rows.size() > 0, "the model lacks its " + name);
  inference::save_checkpoint(folder, checkpoint);
}

Model load_model(const std::string& folder) {
  const inference::Checkpoint checkpoint = inference::load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  Model model;
  model.config = inference::dynamics_config_of(checkpoint.facts, what);
  model.info = inference::dataset_info_of(checkpoint.facts, what);
  try {
    model.split = split_from_json(checkpoint.facts.at("split"));
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.config.members); ++k) {
    const auto part = checkpoint.parts.find(member_part(k));
    if (part == checkpoint.parts.end())
      throw CheckpointError(what + ": part \"" + member_part(k) + "\" is missing");
    const auto member = std::make_shared<Network>(model.config, model.info.layout);
    member->tensors().load(nets::to_tensors(part->second), what + ", " + member_part(k));
    member->train(false);
    model.members.push_back(member);
  }
  model.start_states = checkpoint.at("rows", "start_states", what);
  model.training_rows.state = checkpoint.at("rows", "state", what);
  model.training_rows.action = checkpoint.at("rows", "action", what);
  model.training_rows.next_state = checkpoint.at("rows", "next_state", what);
  return model;
}

}  // namespace lodestone::dynamics
