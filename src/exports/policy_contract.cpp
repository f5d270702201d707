#include "lodestone/exports/policy_contract.h"

#include <algorithm>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/exports/policy_golden.h"

namespace lodestone::exports {
namespace {

using common::Json;

double scale_in_ampere(const inference::Policy& policy, const std::string& what) {
  const bool pairs = !policy.rig.is_object() || !policy.rig.contains("drive") ||
                     policy.rig["drive"].value("kind", "opposed_pairs") == "opposed_pairs";
  if (!pairs || policy.action.size != 2)
    throw common::ConfigError(what +
                              ": its drives are not those of four coils in opposed pairs (rig.drive.kind); "
                              "only policies of such can be exported, as the export ends in currents");
  if (policy.action.unit == "A") return policy.action.scale;
  const Json full_drive = policy.rig.is_object() ? policy.rig.value("full_drive_A", Json()) : Json();
  if (!full_drive.is_number() || !(full_drive > 0.0))
    throw common::ConfigError(what +
                              ": its actions are per cent of drive; train it with a rig.json that says what "
                              "100 per cent are in ampere (full_drive_A)");
  return policy.action.scale * full_drive.get<double>() / 100.0;
}

std::vector<std::string> memory_elements(bool stalls) {
  std::vector<std::string> names = {"known",         "last_x_m",     "last_y_m", "last_heading_rad",
                                    "last_action_x", "last_action_y"};
  if (!stalls) return names;
  for (const char* name : {"place_x_m", "place_y_m", "place_heading_rad"}) names.emplace_back(name);
  for (std::int64_t i = 0; i < MemoryLayout::kStalls; ++i)
    for (const char* axis : {"_x", "_y"}) names.push_back("stalled_" + std::to_string(i) + axis);
  return names;
}

Json values_json(const std::vector<ContractValue>& values) {
  Json json = Json::object();
  for (const ContractValue& value : values)
    json[value.name] = {{"elements", value.elements}, {"description", value.description}};
  return json;
}

}  // namespace

PolicyContract::PolicyContract(const inference::Policy& policy, const std::string& what) : policy_(policy) {
  scale_A_ = scale_in_ampere(policy, what);
  policy.actor(what);
  const task::EncoderConfig& encoder = policy.encoder;
  inputs_.push_back({"pose",
                     {"x_m", "y_m", "heading_rad"},
                     "the needle as sensed, in the dish frame: origin at the centre, x to coil +x, y to coil "
                     "+y, headings of the taped end counter-clockwise from +x"});
  if (encoder.target || encoder.relative_target)
    inputs_.push_back(
        {"target",
         {"x_m", "y_m"},
         encoder.target_ahead ? "where the target will be when the pulse is over" : "where the target is"});
  if (encoder.target_heading)
    inputs_.push_back(
        {"target_heading", {"heading_rad"}, "wanted heading; the needle's own where any will do"});
  if (encoder.drive_gain)
    inputs_.push_back(
        {"drive_gain",
         {"log_mean", "log_sigma"},
         "how strongly this rig answers to a drive beside the one that was learned on: mean and "
         "deviation of the factor's logarithm; 0, 0 where that is not known"});
  outputs_.push_back({"current",
                      {"plus_x_A", "minus_x_A", "plus_y_A", "minus_y_A"},
                      "currents of the coils for the next pulse; opposite coils are never on together"});
  if (!encoder.memory && policy.proposals == 0) return;
  const std::vector<std::string> elements = memory_elements(policy.proposals > 0);
  memory_size_ = static_cast<std::int64_t>(elements.size());
  inputs_.push_back(
      {"memory", elements, "next_memory of the last decision; zeros at the start of an episode"});
  outputs_.push_back(
      {"next_memory", elements, "to be given as memory at the next decision, when the pulse is over"});
}

bool PolicyContract::takes(const std::string& input) const {
  return std::any_of(inputs_.begin(), inputs_.end(),
                     [&](const ContractValue& value) { return value.name == input; });
}

std::vector<float> PolicyContract::weights(const std::string& name) const {
  return policy_.weights.at(name).to_vector<float>();
}

std::int64_t PolicyContract::outputs_of_network() const {
  return inference::Actor::outputs(2, policy_.proposals);
}

std::map<std::string, std::string> PolicyContract::metadata() const {
  Json task = {{"goal", policy_.goal}};
  if (policy_.region) task["region"] = policy_.region->json();
  const Json contract = {{"inputs", values_json(inputs_)}, {"outputs", values_json(outputs_)}};
  return {{"contract", contract.dump()},
          {"task", task.dump()},
          {"rig", policy_.rig.dump()},
          {"provenance", policy_.provenance.dump()},
          {"golden", golden_json(golden_episodes(*this)).dump()},
          {"lodestone", common::build_and_host_facts().at("lodestone").get<std::string>()}};
}

}  // namespace lodestone::exports
