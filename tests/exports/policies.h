#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/exports/policy_golden.h"
#include "lodestone/task/observation.h"

namespace lodestone::tests {

/// Folders of all policies that come with the program.
inline std::vector<std::string> released_policies() {
  std::vector<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(LODESTONE_SOURCE_DIR "/models"))
    if (std::filesystem::exists(entry.path() / "actor.safetensors")) folders.push_back(entry.path().string());
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// A policy that nobody trained, with layers of these widths, and weights as training begins with.
inline inference::Policy untrained_policy(const task::EncoderConfig& encoder, std::int64_t proposals = 0,
                                          const std::vector<std::int64_t>& hidden = {16, 12}) {
  inference::Policy policy;
  policy.hidden = hidden;
  policy.proposals = proposals;
  policy.encoder = encoder;
  policy.encoder.length_scale_m = 0.0425;
  policy.action.scale = 15.0;
  common::RandomStream random(7, "untrained policy");
  std::int64_t inputs = task::ObservationEncoder(policy.encoder).size();
  std::vector<std::int64_t> widths = hidden;
  widths.push_back(inference::Actor::outputs(2, proposals));
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const double most = std::sqrt(3.0 / static_cast<double>(inputs));
    std::vector<float> weight(static_cast<std::size_t>(widths[i] * inputs));
    std::vector<float> bias(static_cast<std::size_t>(widths[i]));
    for (float& number : weight) number = static_cast<float>(random.uniform(-most, most));
    for (float& number : bias) number = static_cast<float>(random.uniform(-most, most));
    const std::string layer = "l" + std::to_string(i + 1);
    policy.weights[layer + ".weight"] = {weight, {widths[i], inputs}};
    policy.weights[layer + ".bias"] = {bias, {widths[i]}};
    inputs = widths[i];
  }
  return policy;
}

/// One of every kind of encoding, action and network.
inline std::vector<inference::Policy> policies_of_every_kind() {
  std::vector<inference::Policy> policies;
  task::EncoderConfig encoder;
  policies.push_back(untrained_policy(encoder));
  encoder.heading = task::HeadingEncoding::kNone;
  encoder.memory = true;
  policies.push_back(untrained_policy(encoder, 0, {8}));
  policies.back().action.one_axis_at_a_time = true;
  policies.back().action.unit = "percent";
  policies.back().action.scale = 100.0;
  policies.back().rig = {{"full_drive_A", 3.5}};
  encoder.heading = task::HeadingEncoding::kSineCosine;
  encoder.target = false;
  encoder.relative_target = true;
  encoder.target_heading = true;
  policies.push_back(untrained_policy(encoder, 0, {}));
  policies.back().action.dead_band = 0.4;
  encoder.drive_gain = true;
  encoder.target_ahead = true;
  encoder.fine_distance_m = 2e-4;
  policies.push_back(untrained_policy(encoder, 3));
  encoder.memory = false;
  encoder.relative_target = false;
  policies.push_back(untrained_policy(encoder, 1));
  return policies;
}

}  // namespace lodestone::tests
