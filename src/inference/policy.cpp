#include "lodestone/inference/policy.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/inference/checkpoint.h"

namespace lodestone::inference {
namespace {

using common::CheckpointError;
using common::Json;

constexpr const char* kKind = "policy";
constexpr std::int64_t kExamples = 16;
constexpr double kExampleTolerance = 1e-5;
constexpr std::int64_t kMostProposals = 64;

/// Observations over the range encoders give, always the same.
std::vector<float> example_observations(std::int64_t size) {
  common::RandomStream random(1, "policy examples");
  std::vector<float> observations(static_cast<std::size_t>(kExamples * size));
  for (float& value : observations) value = static_cast<float>(random.uniform(-1.0, 1.0));
  return observations;
}

std::vector<float> actions_for(const Actor& actor, const std::vector<float>& observations) {
  const std::int64_t rows = static_cast<std::int64_t>(observations.size()) / actor.observation_size();
  std::vector<float> actions(static_cast<std::size_t>(rows * actor.action_size()));
  Actor::Workspace workspace;
  actor.act(observations.data(), rows, actions.data(), workspace);
  return actions;
}

void check_examples(const Actor& actor, const Checkpoint& checkpoint, const std::string& what) {
  const auto examples = checkpoint.parts.find("examples");
  if (examples == checkpoint.parts.end()) throw CheckpointError(what + ": part \"examples\" is missing");
  const Array& given = checkpoint.at("examples", "observation", what);
  const std::int64_t rows = given.shape().empty() ? 0 : given.shape().front();
  if (rows < 1) throw CheckpointError(what + ": there is no example observation");
  const auto stored_in = [&](const char* name, std::int64_t columns) {
    return weight_at(examples->second, name, {rows, columns}, what + ", examples").to_vector<float>();
  };
  const std::vector<float> recomputed =
      actions_for(actor, stored_in("observation", actor.observation_size()));
  const std::vector<float> stored = stored_in("action", actor.action_size());
  float error = 0.0F;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const float difference = std::abs(recomputed[i] - stored[i]);
    if (!(difference <= error)) error = difference;  // what is not a number counts
  }
  if (!(error <= kExampleTolerance)) {
    throw CheckpointError(what + ": recomputed example actions differ by " + std::to_string(error) +
                          ", at most 1e-5 is allowed; this build computes the network differently");
  }
}

std::vector<std::int64_t> hidden_from_json(const Json& list, const std::string& what) {
  const auto fits = [](const Json& width) {
    return width.is_number_unsigned() && width >= 1 && width <= kWidestLayer;
  };
  if (!list.is_array() || list.size() > kMostLayers || !std::all_of(list.begin(), list.end(), fits))
    throw CheckpointError(what + ": hidden = " + common::shown_json(list) + " must be at most " +
                          std::to_string(kMostLayers) + " widths within 1 .. " +
                          std::to_string(kWidestLayer));
  return list.get<std::vector<std::int64_t>>();
}

std::int64_t proposals_from_json(const Json& count, const std::string& what) {
  if (!count.is_number_integer() || count < 0 || count > kMostProposals)
    throw CheckpointError(what + ": proposals = " + common::shown_json(count) + " must be within 0 .. " +
                          std::to_string(kMostProposals));
  return count.get<std::int64_t>();
}

common::Json cost_to_go_facts(const CostToGo& learned) {
  common::Json facts = common::config_to_json(learned.cost());
  facts["dish_radius_m"] = learned.cost().dish_radius_m;
  return {{"hidden", learned.hidden()}, {"cost", facts}};
}

std::optional<CostToGo> cost_to_go_of(const Checkpoint& checkpoint, const std::string& what) {
  const auto facts = checkpoint.facts.find("cost_to_go");
  if (facts == checkpoint.facts.end()) return std::nullopt;
  const auto part = checkpoint.parts.find("cost_to_go");
  if (part == checkpoint.parts.end()) throw CheckpointError(what + ": part \"cost_to_go\" is missing");
  try {
    Json rules = facts->at("cost");
    const double dish_radius_m = rules.at("dish_radius_m").get<double>();
    if (!(dish_radius_m > 0.0 && dish_radius_m <= 1.0))
      throw CheckpointError(what + ": cost_to_go: dish_radius_m = " +
                            common::shown_json(rules["dish_radius_m"]) + " must be above 0 and at most 1");
    rules.erase("dish_radius_m");
    auto cost = common::config_from_json<PoseCost>(rules, what + ", cost_to_go");
    cost.dish_radius_m = dish_radius_m;
    return CostToGo(part->second, hidden_from_json(facts->at("hidden"), what), cost, what + ", cost_to_go");
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": cost_to_go is malformed: " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": cost_to_go is malformed: " + error.what());
  }
}

Policy policy_from_facts(const Json& facts, const std::string& what) {
  Policy policy;
  try {
    policy.hidden = hidden_from_json(facts.at("hidden"), what);
    policy.proposals = proposals_from_json(facts.value("proposals", Json(0)), what);
    policy.encoder = task::encoder_from_json(facts.at("encoder"), what);
    policy.action = task::action_from_json(facts.at("action"), what);
    if (policy.encoder.action_size != policy.action.size)
      throw CheckpointError(what + ": encoder and action are of different sizes");
    policy.goal = facts.at("goal").get<std::string>();
    policy.rig = facts.value("rig", Json());
    if (facts.contains("region")) policy.region = task::Region::from_json(facts["region"]);
    policy.provenance = facts.value("provenance", Json::object());
  } catch (const Json::exception& error) {
    throw CheckpointError(what + ": facts are malformed: " + error.what());
  } catch (const common::DataError& error) {
    throw CheckpointError(what + ": " + error.what());
  } catch (const common::ConfigError& error) {
    throw CheckpointError(what + ": encoder or action is malformed: " + error.what());
  }
  return policy;
}

}  // namespace

Actor Policy::actor(const std::string& what) const {
  return Actor(weights, task::ObservationEncoder(encoder).size(), hidden, action.size, what, proposals);
}

void save_policy(const std::string& folder, const Policy& policy, const Json& run_config,
                 const Json& metrics) {
  Checkpoint checkpoint;
  checkpoint.kind = kKind;
  checkpoint.config = run_config;
  checkpoint.facts["hidden"] = policy.hidden;
  if (policy.proposals > 0) checkpoint.facts["proposals"] = policy.proposals;
  checkpoint.facts["encoder"] = task::encoder_to_json(policy.encoder);
  checkpoint.facts["action"] = task::action_to_json(policy.action);
  checkpoint.facts["goal"] = policy.goal;
  checkpoint.facts["rig"] = policy.rig;
  if (policy.region) checkpoint.facts["region"] = policy.region->json();
  checkpoint.facts["metrics"] = metrics;
  checkpoint.facts["provenance"] = policy.provenance;
  checkpoint.parts["actor"] = policy.weights;
  if (policy.cost_to_go) {
    checkpoint.facts["cost_to_go"] = cost_to_go_facts(*policy.cost_to_go);
    checkpoint.parts["cost_to_go"] = policy.cost_to_go->weights();
  }
  const Actor actor = policy.actor();
  const std::vector<float> observations = example_observations(actor.observation_size());
  checkpoint.parts["examples"] = {
      {"observation", Array(observations, {kExamples, actor.observation_size()})},
      {"action", Array(actions_for(actor, observations), {kExamples, actor.action_size()})}};
  save_checkpoint(folder, checkpoint);
}

void set_policy_provenance(const std::string& folder, const Json& provenance) {
  Checkpoint checkpoint = load_checkpoint(folder, kKind);
  checkpoint.facts["provenance"] = provenance;
  save_checkpoint(folder, checkpoint);
}

Policy load_policy(const std::string& folder) {
  const Checkpoint checkpoint = load_checkpoint(folder, kKind);
  const std::string what = "checkpoint " + folder;
  Policy policy = policy_from_facts(checkpoint.facts, what);
  const auto part = checkpoint.parts.find("actor");
  if (part == checkpoint.parts.end()) throw CheckpointError(what + ": part \"actor\" is missing");
  policy.weights = part->second;
  check_examples(policy.actor(what + ", actor"), checkpoint, what);
  policy.cost_to_go = cost_to_go_of(checkpoint, what);
  return policy;
}

}  // namespace lodestone::inference
