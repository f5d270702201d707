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

DataSplit split_from_json(const Json& json, const std::string& what) {
  const DataSplit split{json.at("seed").get<std::uint64_t>(), json.at("validation_fraction").get<double>(),
                        json.at("test_fraction").get<double>()};
  for (const double fraction : {split.validation_fraction, split.test_fraction})
    if (!(fraction >= 0.0 && fraction < 1.0))
      throw CheckpointError(what + ": split = " + common::shown_json(json) +
                            " must have fractions from 0 to 1");
  return split;
}

}  // namespace

void save_model(const std::string& folder, const Model& model, const Json& run_config, const Json& metrics) {
  inference::Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = run_config;
  checkpoint.facts["model"] = common::config_to_json(model.config);
  checkpoint.facts["dataset"] = data::info_to_json(model.info);
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
    model.split = split_from_json(checkpoint.facts.at("split"), what);
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.config.members); ++k) {
    const auto part = checkpoint.parts.find(member_part(k));
    if (part == checkpoint.parts.end())
      throw CheckpointError(what + ": part \"" + member_part(k) + "\" is missing");
    const std::string name = what + ", " + member_part(k);
    // First, so that memory is taken only for a shape that the file fills with usable numbers.
    inference::FoldedDynamics(part->second, model.config, model.info.rows(), name);
    const auto member = std::make_shared<Network>(model.config, model.info.rows());
    member->tensors().load(nets::to_tensors(part->second), name);
    member->train(false);
    model.members.push_back(member);
  }
  const int size = data::state_size(model.info.layout);
  model.start_states = inference::training_rows(checkpoint, "start_states", size, what);
  model.training_rows.state = inference::training_rows(checkpoint, "state", size, what);
  model.training_rows.action = inference::training_rows(checkpoint, "action", model.info.action_size, what);
  model.training_rows.next_state = inference::training_rows(checkpoint, "next_state", size, what);
  const std::int64_t rows = model.training_rows.state.shape()[0];
  if (model.training_rows.action.shape()[0] != rows || model.training_rows.next_state.shape()[0] != rows)
    throw CheckpointError(what + ": part \"rows\" has not as many actions and next states as states");
  return model;
}

}  // namespace lodestone::dynamics
